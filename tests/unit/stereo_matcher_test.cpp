// Depth by stereo matching: its noise by hand, matching against exact truth.
#include "core/sequence/stereo/stereo_matcher.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "core/median.hpp"
#include "core/motion/stillpoint/depth_motion.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;

Camera rig(double baseline_m = 0.12) {
  Camera camera = camera_by_name("generated");
  camera.baseline_m = baseline_m;
  return camera;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

/// Smooth noise that has texture everywhere and repeats nowhere, CV_8UC1, moved to the left by `shift` px.
cv::Mat texture(cv::Size size, double shift) {
  cv::Mat noise(size.height, size.width + 64, CV_8UC1), image;
  cv::RNG(5).fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, noise, {0, 0}, 1.5);
  noise.convertTo(noise, CV_8U, 3.0, -256.0);
  const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, -shift, 0, 1, 0);
  cv::warpAffine(noise, image, move, size, cv::INTER_CUBIC);
  return image;
}

// ---- noise

TEST(DepthNoise, IsTheOneOfTheFormula) {
  EXPECT_NEAR(kKinectNoise.sigma(2.0F), 0.0012F + 0.0019F * 4.0F, 1e-7F);
  // sigma_z = z² sigma_d / (f b): 9 * 0.3 / (535.4 * 0.12)
  Camera camera = rig();
  camera.depth_sigma_per_m2 = 0.3 / (535.4 * 0.12);
  EXPECT_NEAR(camera.depth_noise(kKinectNoise).sigma(3.0F), 9.0 * 0.3 / 64.248, 1e-6);
  EXPECT_NEAR(camera.stereo_sigma(3.0), 0.0420247, 1e-6);
  EXPECT_EQ(camera.depth_noise(kKinectNoise).floor_m, 0.0F);
}

TEST(DepthNoise, OfASensorIsTheSensors) {
  const Camera kinect = camera_by_name("freiburg3");
  EXPECT_FALSE(kinect.is_stereo());
  EXPECT_EQ(kinect.depth_noise(kKinectNoise).sigma(3.0F), kKinectNoise.sigma(3.0F));
  EXPECT_EQ(kinect.stereo_sigma(3.0), 0.0);
  EXPECT_EQ(kinect.depth_limit(3.0), 3.0);
  EXPECT_EQ(kinect.baseline_or(0.08), 0.08);
}

TEST(DepthNoise, LimitsAreAsManyBaselinesAway) {
  EXPECT_NEAR(rig(0.537).depth_limit(3.0), 40 * 0.537, 1e-9);  // KITTI: 21.5 m
  EXPECT_NEAR(rig(0.12).depth_limit(3.0), 4.8, 1e-9);
  EXPECT_EQ(rig(0.537).baseline_or(0.075), 0.537);
}

TEST(DepthNoise, OfAViewIsItsCameras) {
  const cv::Mat gray(48, 64, CV_8UC1, cv::Scalar(100)), depth(48, 64, CV_32FC1, cv::Scalar(2));
  const StereoMatcher matcher(rig(), {});
  EXPECT_EQ(depth_noise(make_rgbd_view(gray, depth, camera_by_name("generated"), 4)).sigma(2.0F),
            kKinectNoise.sigma(2.0F));
  // The small image's camera has another focal length, and the same noise in metres.
  EXPECT_NEAR(depth_noise(make_rgbd_view(gray, depth, matcher.camera(), 4)).sigma(2.0F),
              matcher.camera().stereo_sigma(2.0), 1e-6);
}

// ---- options

TEST(StereoOptions, ComeBackFromTheirText) {
  for (const StereoOptions& options :
       {StereoOptions{}, StereoOptions{true, 0, true}, StereoOptions{false, 96, false}})
    EXPECT_EQ(stereo_options_from(to_text(options), "--stereo"), options) << to_text(options);
  EXPECT_EQ(to_text({true, 96, false}), "size=half,disparities=96,check=off");
  EXPECT_EQ(to_text({}), "");
}

TEST(StereoOptions, SayWhatIsWrong) {
  const auto sentence = [](const char* text) {
    return input_error_of([&] { (void)stereo_options_from(text, "--stereo"); });
  };
  EXPECT_THAT(sentence("size=quarter"), HasSubstr("--stereo: size takes half or full"));
  EXPECT_THAT(sentence("disparities=50"), HasSubstr("disparities=50 is no multiple of 16 from 16 to 512"));
  EXPECT_THAT(sentence("disparities=1e9"), HasSubstr("no multiple of 16"));
  EXPECT_THAT(sentence("check=maybe"), HasSubstr("check takes on or off"));
  EXPECT_THAT(sentence("fast"), HasSubstr("size=full|half, disparities=N and check=on|off"));
}

// ---- matching

TEST(StereoMatcher, FindsAKnownShiftBetweenPixels) {
  constexpr double kShift = 21.25;  // px
  const cv::Size size(640, 480);
  const cv::Mat left = texture(size, 0.0), right = texture(size, kShift);
  for (const bool half : {false, true}) {
    const StereoMatch match = StereoMatcher(rig(), {.half = half}).match(left, right);
    std::vector<float> found;
    for (int y = 20; y < 460; y += 3)
      for (int x = 0; x < 640; x += 3)
        if (const float d = match.disparity.at<float>(y, x); d > 0) found.push_back(d);
    EXPECT_GT(found.size(), 20000U) << half;
    // SGBM locks to whole pixels, of which one of half the size is two.
    EXPECT_NEAR(median_of(found), kShift, half ? 0.6 : 0.2) << half;
    // What lies left of the right image has no match.
    EXPECT_NE(match.holes.at<std::uint8_t>(240, 5), static_cast<int>(StereoHole::none)) << half;
    EXPECT_EQ(match.disparity.at<float>(240, 5), 0.0F) << half;
  }
}

TEST(StereoMatcher, TellsEveryPixelWithoutDepthWhy) {
  const auto frame = make_generated_sequence("walking_static:stereo", 1, 1)->read(0);
  ASSERT_NE(frame.stereo, nullptr);
  const cv::Mat none = frame.depth == 0, told = frame.stereo->holes != 0;
  EXPECT_TRUE(same(none, told));
  EXPECT_GT(cv::countNonZero(frame.stereo->holes == static_cast<int>(StereoHole::rejected)), 100);
  EXPECT_GT(cv::countNonZero(frame.stereo->holes == static_cast<int>(StereoHole::outside)), 100);
}

TEST(StereoMatcher, GivesTheSameWhateverTheThreads) {
  const cv::Mat left = texture({320, 240}, 0.0), right = texture({320, 240}, 9.5);
  Camera camera = rig().scaled_to(320, 240);
  const StereoMatcher matcher(camera, {});
  const int threads = cv::getNumThreads();
  // Many first: once TBB was held to one thread it stays with it.
  cv::setNumThreads(4);
  const cv::Mat together = matcher.match(left, right).disparity;
  cv::setNumThreads(1);
  const cv::Mat alone = matcher.match(left, right).disparity;
  cv::setNumThreads(threads);
  EXPECT_TRUE(same(alone, together));
}

TEST(StereoMatcher, ReachesAsNearAsItSays) {
  const StereoMatcher usual(rig(), {}), near(rig(), {.disparities = 256});
  EXPECT_EQ(usual.disparities(), 128);
  EXPECT_NEAR(usual.nearest_m(), 535.4 * 0.12 / 128, 1e-9);
  EXPECT_EQ(near.disparities(), 256);
  // A small image has small disparities.
  EXPECT_EQ(StereoMatcher(rig().scaled_to(320, 240), {}).disparities(), 64);
}

TEST(StereoMatcher, TakesTheSmallestImages) {
  const Camera camera = rig().scaled_to(32, 32);
  for (const StereoOptions& options : {StereoOptions{}, StereoOptions{true, 512, true}}) {
    const StereoMatch match =
        StereoMatcher(camera, options).match(texture({32, 32}, 0), texture({32, 32}, 3));
    EXPECT_EQ(match.disparity.size(), cv::Size(32, 32));
    EXPECT_EQ(match.holes.size(), cv::Size(32, 32));
  }
}

TEST(StereoMatcher, ImagesOfNothingGiveNoDepthAndSaySo) {
  const StereoMatcher matcher(rig(), {});
  Frame frame;
  frame.gray = cv::Mat(480, 640, CV_8UC1, cv::Scalar(90));
  matcher.match(frame, frame.gray.clone());
  EXPECT_FALSE(frame.has_depth());
  EXPECT_THAT(frame.problem, HasSubstr("match nowhere"));
}

TEST(StereoMatcher, DisparityIsDepthsInverse) {
  const Camera camera = rig();
  cv::Mat depth(4, 4, CV_32FC1, cv::Scalar(0));
  depth.at<float>(1, 2) = 2.0F;
  const cv::Mat disparity = disparity_of(depth, camera);
  EXPECT_NEAR(disparity.at<float>(1, 2), 535.4 * 0.12 / 2.0, 1e-4);
  EXPECT_EQ(cv::countNonZero(disparity), 1);
}

/// Errors of matching (px) against what the ray caster knows, and how much was matched.
struct Against {
  double median = 0, spread = 0, wild = 0;  // px, px (robust sigma), share beyond 3 px
  double holes = 0;                         // share of what both cameras could see
};

Against against_truth(const char* kind, const StereoOptions& options) {
  const auto source = make_generated_sequence(kind, 30, 1, options);
  const Camera& camera = source->camera();
  const Frame frame = source->read(20);
  const cv::Mat truth = disparity_of(source->truth(20).depth, camera),
                found = disparity_of(frame.depth, camera);
  std::vector<double> errors;
  double in_view = 0, wild = 0;
  for (int y = 0; y < truth.rows; ++y)
    for (int x = 0; x < truth.cols; ++x) {
      const double d = truth.at<float>(y, x);
      if (d > x) continue;
      ++in_view;
      if (const double f = found.at<float>(y, x); f > 0) {
        errors.push_back(std::abs(f - d));
        wild += errors.back() > 3.0 ? 1 : 0;
      }
    }
  Against result;
  result.holes = 1.0 - static_cast<double>(errors.size()) / in_view;
  result.wild = wild / static_cast<double>(errors.size());
  result.median = median_of(errors);
  result.spread = 1.4826 * result.median;
  return result;
}

TEST(StereoMatcher, IsRightToHalfAPixelOnAGeneratedRig) {
  for (const char* kind : {"walking_xyz:stereo", "room:stereo"})
    for (const bool half : {false, true}) {
      const Against truth = against_truth(kind, {.half = half});
      RecordProperty(
          std::string(kind) + (half ? " half" : " full"),
          fmt::format("{:.3f} px, wild {:.4f}, holes {:.3f}", truth.median, truth.wild, truth.holes));
      EXPECT_LT(truth.median, 0.5) << kind << half;
      EXPECT_LT(truth.wild, half ? 0.10 : 0.07) << kind << half;  // at outlines
      EXPECT_LT(truth.holes, 0.35) << kind << half;
      EXPECT_GT(truth.holes, 0.001) << "the check takes out what one camera alone sees";
    }
}

TEST(StereoMatcher, TheLeftRightCheckTakesOutWhatIsWrong) {
  const Against with = against_truth("walking_xyz:stereo", {}),
                without = against_truth("walking_xyz:stereo", {.left_right_check = false});
  EXPECT_LT(with.wild, without.wild);
  EXPECT_GT(with.holes, without.holes);
}

TEST(GeneratedStereo, LeftImagesAreThoseOfTheKind) {
  const auto plain = make_generated_sequence("walking_xyz", 3, 5),
             stereo = make_generated_sequence("walking_xyz:stereo", 3, 5);
  EXPECT_EQ(stereo->name(), "generated:walking_xyz:stereo");
  EXPECT_EQ(stereo->camera().baseline_m, 0.12);
  EXPECT_FALSE(plain->camera().is_stereo());
  EXPECT_EQ(plain->read(2).stereo, nullptr);
  EXPECT_TRUE(same(plain->read(2).colour, stereo->read(2).colour));
  EXPECT_TRUE(same(plain->truth(2).moving, stereo->truth(2).moving));
  EXPECT_FALSE(same(stereo->read(2).colour, stereo->read(2).stereo->right));
}

}  // namespace
}  // namespace stillpoint
