#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/motion/paper/compensation.hpp"
#include "core/motion/paper/detect_motion.hpp"
#include "core/motion/paper/homography.hpp"
#include "tests/unit/motion_scene.hpp"

namespace stillpoint {
namespace {

using motion_test::plane_and_patch;
using motion_test::PlaneAndPatch;
using motion_test::textured_image;

const cv::Size kVga(640, 480);

/// A patch of a figure's size that moves on its own, by about one of its stripes relative to the plane around
/// it.
PlaneAndPatch walking_patch() { return plane_and_patch(kVga, {260, 120, 130, 240}, {20, -1}, 16); }

/// A larger patch whose motion, 8 px off the plane's, lies within the RANSAC threshold of pulled_config().
PlaneAndPatch pulling_patch() { return plane_and_patch(kVga, {360, 60, 240, 380}, {12, 0}, 8); }

PaperConfig pulled_config() {
  PaperConfig config;
  config.ransac_threshold_px = 12.0;
  config.max_rounds = 6;
  return config;
}

double corner_error_px(const cv::Matx33d& truth, const cv::Matx33d& estimate, const cv::Size& size) {
  double worst = 0.0;
  for (const cv::Point2d corner : {cv::Point2d(0, 0), {size.width - 1.0, 0}, {0, size.height - 1.0}})
    worst = std::max(worst, cv::norm(carry(truth, corner) - carry(estimate, corner)));
  return worst;
}

void expect_equal_images(const cv::Mat& a, const cv::Mat& b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  ASSERT_EQ(a.type(), b.type()) << what;
  if (a.empty()) return;
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0.0) << what;
}

void expect_equal_directions(const DirectionTrace& a, const DirectionTrace& b) {
  ASSERT_EQ(a.tracks.size(), b.tracks.size());
  for (std::size_t i = 0; i < a.tracks.size(); ++i) {
    EXPECT_EQ(a.tracks[i].from, b.tracks[i].from);
    EXPECT_EQ(a.tracks[i].to, b.tracks[i].to);
    EXPECT_EQ(a.tracks[i].residual, b.tracks[i].residual);
    EXPECT_EQ(a.tracks[i].removed, b.tracks[i].removed);
    EXPECT_EQ(a.tracks[i].inlier, b.tracks[i].inlier);
  }
  EXPECT_EQ(a.homography.matrix, b.homography.matrix);
  EXPECT_EQ(a.homography.valid, b.homography.valid);
  EXPECT_EQ(a.homography.refined_error_px, b.homography.refined_error_px);
  EXPECT_EQ(a.threshold, b.threshold);
  expect_equal_images(a.compensated, b.compensated, "compensated");
  expect_equal_images(a.valid, b.valid, "valid");
  expect_equal_images(a.difference, b.difference, "difference");
  expect_equal_images(a.raw_mask, b.raw_mask, "raw mask");
  expect_equal_images(a.mask, b.mask, "mask");
}

void expect_equal_traces(const PaperTrace& a, const PaperTrace& b) {
  EXPECT_EQ(a.converged, b.converged);
  EXPECT_EQ(a.note, b.note);
  ASSERT_EQ(a.rounds.size(), b.rounds.size());
  for (std::size_t i = 0; i < a.rounds.size(); ++i) {
    expect_equal_directions(a.rounds[i].forward, b.rounds[i].forward);
    expect_equal_directions(a.rounds[i].backward, b.rounds[i].backward);
    expect_equal_images(a.rounds[i].backward_mask_in_target, b.rounds[i].backward_mask_in_target,
                        "carried mask");
    expect_equal_images(a.rounds[i].mask, b.rounds[i].mask, "union");
  }
}

TEST(DetectMotion, UnionCoversThePatchAndHardlyAnythingElse) {
  const PlaneAndPatch scene = walking_patch();
  const PaperTrace trace = detect_motion(scene.reference, scene.target, PaperConfig{});
  ASSERT_FALSE(trace.mask().empty());
  EXPECT_EQ(trace.note, "");
  const MotionRound& last = trace.rounds.back();
  EXPECT_LT(corner_error_px(scene.target_from_reference, last.forward.homography.matrix, kVga), 0.5);

  const double covered =
      cv::countNonZero(trace.mask()(scene.patch)) / static_cast<double>(scene.patch.area());
  EXPECT_GT(covered, 0.9);
  // What the patch uncovers differs too: some 16 px beside it, and 5 px of dilation all around.
  cv::Mat elsewhere = trace.mask().clone();
  elsewhere(cv::Rect(scene.patch.x - 24, scene.patch.y - 8, scene.patch.width + 32, scene.patch.height + 16))
      .setTo(0);
  EXPECT_LT(cv::countNonZero(elsewhere), 640 * 480 / 200);
}

TEST(DetectMotion, UnionHoldsBothDirectionsAndForwardAloneIsLess) {
  const PlaneAndPatch scene = walking_patch();
  const PaperTrace trace = detect_motion(scene.reference, scene.target, PaperConfig{});
  ASSERT_FALSE(trace.rounds.empty());
  for (const MotionRound& round : trace.rounds) {
    expect_equal_images(round.mask, round.forward.mask | round.backward_mask_in_target, "union");
    EXPECT_GT(cv::countNonZero(round.mask), cv::countNonZero(round.forward.mask));
    EXPECT_DOUBLE_EQ(round.mask_share, cv::countNonZero(round.mask) / (640.0 * 480.0));
  }
}

TEST(DetectMotion, RemovedTracksLieInTheMaskOfTheRoundBefore) {
  const PlaneAndPatch scene = pulling_patch();
  const PaperTrace trace = detect_motion(scene.reference, scene.target, pulled_config());
  ASSERT_GE(trace.rounds.size(), 2U);
  for (const Track& track : trace.rounds[0].forward.tracks) EXPECT_FALSE(track.removed);
  int removed = 0;
  const cv::Mat& before = trace.rounds[0].mask;
  for (const Track& track : trace.rounds[1].forward.tracks) {
    EXPECT_EQ(track.removed, before.at<unsigned char>(cvRound(track.to.y), cvRound(track.to.x)) != 0);
    removed += track.removed ? 1 : 0;
  }
  for (const Track& track : trace.rounds[1].backward.tracks)  // from frame t, the mask's camera
    EXPECT_EQ(track.removed, before.at<unsigned char>(cvRound(track.from.y), cvRound(track.from.x)) != 0);
  EXPECT_GE(removed, 5);
}

TEST(DetectMotion, RoundsImproveAHomographyThatACoherentPatchPulls) {
  const PlaneAndPatch scene = pulling_patch();
  const PaperTrace trace = detect_motion(scene.reference, scene.target, pulled_config());
  ASSERT_GE(trace.rounds.size(), 2U);
  const auto error = [&](const MotionRound& round) {
    return corner_error_px(scene.target_from_reference, round.forward.homography.matrix, kVga);
  };
  EXPECT_GT(error(trace.rounds.front()), 0.3);
  EXPECT_LT(error(trace.rounds.back()), 0.5 * error(trace.rounds.front()));
}

TEST(DetectMotion, NothingInTheBorderWithoutData) {
  const PlaneAndPatch scene = walking_patch();
  const PaperTrace trace = detect_motion(scene.reference, scene.target, PaperConfig{});
  ASSERT_FALSE(trace.rounds.empty());
  for (const MotionRound& round : trace.rounds) {
    EXPECT_GT(cv::countNonZero(~round.forward.valid), 2000);
    EXPECT_GT(cv::countNonZero(round.mask), 0);
    EXPECT_EQ(cv::countNonZero(round.forward.mask & ~round.forward.valid), 0);
    EXPECT_EQ(cv::countNonZero(round.forward.difference & ~round.forward.valid), 0);
    EXPECT_EQ(cv::countNonZero(round.backward.mask & ~round.backward.valid), 0);
    EXPECT_EQ(cv::countNonZero(round.mask & ~round.forward.valid), 0);
  }
}

TEST(DetectMotion, SameBytesWhateverTheThreads) {
  const PlaneAndPatch scene = walking_patch();
  const int opencv_threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const PaperTrace alone = detect_motion(scene.reference, scene.target, PaperConfig{}, 1);
  const PaperTrace beside = detect_motion(scene.reference, scene.target, PaperConfig{}, 2);
  cv::setNumThreads(4);
  const PaperTrace many = detect_motion(scene.reference, scene.target, PaperConfig{}, 2);
  cv::setNumThreads(opencv_threads);
  expect_equal_traces(alone, beside);
  expect_equal_traces(alone, many);
}

TEST(DetectMotion, PreparedFramesGiveTheSameAndServeTwice) {
  const PlaneAndPatch scene = walking_patch();
  const PaperConfig config;
  const MotionFrame reference = prepare_motion_frame(scene.reference, config);
  const MotionFrame target = prepare_motion_frame(scene.target, config);
  const PaperTrace direct = detect_motion(scene.reference, scene.target, config);
  expect_equal_traces(direct, detect_motion(reference, target, config));
  expect_equal_traces(direct, detect_motion(reference, target, config, 2));
  expect_equal_traces(detect_motion(scene.target, scene.reference, config),
                      detect_motion(target, reference, config));
}

TEST(DetectMotion, ADirectionWhoseTracksStaySeesTheSameAgain) {
  int stayed = 0;
  for (int i = 0; i < 12; ++i) {
    const PlaneAndPatch scene = plane_and_patch({320, 240}, {90, 60, 100, 120}, {12 + i, 0}, 8);
    const PaperConfig config = pulled_config();
    const PaperTrace trace = detect_motion(scene.reference, scene.target, config);
    for (std::size_t r = 1; r < trace.rounds.size(); ++r)
      for (auto direction : {&MotionRound::forward, &MotionRound::backward}) {
        const DirectionTrace &before = trace.rounds[r - 1].*direction, &now = trace.rounds[r].*direction;
        std::vector<Track> tracks = now.tracks;
        const bool same = std::equal(tracks.begin(), tracks.end(), before.tracks.begin(),
                                     [](const Track& a, const Track& b) { return a.removed == b.removed; });
        const HomographyEstimate anew =
            estimate_homography(tracks, scene.target.size(), config, before.homography.matrix);
        EXPECT_EQ(now.homography.matrix, anew.matrix);
        EXPECT_EQ(now.homography.valid, anew.valid);
        if (!same) continue;
        ++stayed;
        expect_equal_directions(now, before);
      }
  }
  EXPECT_GT(stayed, 0);
}

TEST(DetectMotion, ForwardAndBackwardChangePlacesWithTheFrames) {
  const PlaneAndPatch scene = walking_patch();
  PaperConfig config;
  config.max_rounds = 1;
  const PaperTrace there = detect_motion(scene.reference, scene.target, config);
  const PaperTrace back = detect_motion(scene.target, scene.reference, config);
  expect_equal_directions(there.rounds[0].forward, back.rounds[0].backward);
  expect_equal_directions(there.rounds[0].backward, back.rounds[0].forward);
}

TEST(DetectMotion, EqualFramesShowNoMotion) {
  const cv::Mat image = textured_image(kVga, 1);
  const PaperTrace trace = detect_motion(image, image, PaperConfig{});
  ASSERT_EQ(trace.rounds.size(), 1U);
  EXPECT_TRUE(trace.converged);
  EXPECT_EQ(cv::countNonZero(trace.rounds[0].forward.difference), 0);
  EXPECT_EQ(trace.rounds[0].forward.threshold, 0.0);
  EXPECT_EQ(cv::countNonZero(trace.mask()), 0);
}

TEST(DetectMotion, PairsWithoutTextureGiveANoteAndNoMask) {
  const cv::Mat black = cv::Mat::zeros(kVga, CV_8UC1), grey(kVga, CV_8UC1, cv::Scalar(128));
  const cv::Mat image = textured_image(kVga, 1);
  cv::Mat noise(kVga, CV_8UC1), other_noise(kVga, CV_8UC1);
  cv::RNG random(3);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  random.fill(other_noise, cv::RNG::UNIFORM, 0, 256);
  const std::vector<std::pair<cv::Mat, cv::Mat>> pairs = {
      {black, black}, {grey, grey}, {black, image}, {image, black}, {black, grey}, {noise, other_noise}};
  for (const auto& [reference, target] : pairs) {
    const PaperTrace trace = detect_motion(reference, target, PaperConfig{}, 2);
    EXPECT_TRUE(trace.mask().empty());
    EXPECT_EQ(trace.rounds.size(), 1U);
    EXPECT_NE(trace.note.find("no mask"), std::string::npos) << trace.note;
  }
}

TEST(DetectMotion, TooSmallFramesGiveANote) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(31, 400), cv::Size(400, 2)}) {
    const cv::Mat image(size, CV_8UC1, cv::Scalar(9));
    const PaperTrace trace = detect_motion(image, image, PaperConfig{});
    EXPECT_TRUE(trace.rounds.empty());
    EXPECT_TRUE(trace.mask().empty());
    EXPECT_NE(trace.note.find("too small"), std::string::npos);
  }
}

TEST(DetectMotion, AnySizeWorks) {
  for (const cv::Size size :
       {cv::Size(32, 32), cv::Size(47, 33), cv::Size(33, 47), cv::Size(641, 479), cv::Size(1280, 960)}) {
    const cv::Mat plane = textured_image({size.width + 8, size.height + 8}, 17);
    const cv::Mat reference = plane(cv::Rect({4, 4}, size)).clone(),
                  target = plane(cv::Rect({3, 6}, size)).clone();
    PaperConfig config;
    config.min_tracks = 6;
    config.corner_distance_px = 3;
    const PaperTrace trace = detect_motion(reference, target, config, 2);
    ASSERT_EQ(trace.mask().size(), size) << size << ' ' << trace.note;
    EXPECT_LT(
        corner_error_px({1, 0, 1, 0, 1, -2, 0, 0, 1}, trace.rounds.back().forward.homography.matrix, size),
        0.5)
        << size;
  }
}

TEST(DetectMotion, FramesOfOtherSizeOrTypeAreRefused) {
  const cv::Mat gray = textured_image(kVga, 1);
  const PaperConfig config;
  EXPECT_THROW(static_cast<void>(detect_motion(gray, gray.colRange(0, 320), config)), InputError);
  EXPECT_THROW(static_cast<void>(detect_motion(gray, cv::Mat(kVga, CV_8UC3), config)), InputError);
  EXPECT_THROW(static_cast<void>(detect_motion(cv::Mat(kVga, CV_16UC1), gray, config)), InputError);
  EXPECT_THROW(static_cast<void>(detect_motion(cv::Mat(), gray, config)), InputError);
}

TEST(DetectMotion, FewStaticTracksKeepTheLastHomography) {
  const PlaneAndPatch scene = pulling_patch();
  PaperConfig config = pulled_config();
  config.ransac_threshold_px = 50.0;  // every track is an inlier of the first round
  const PaperTrace free = detect_motion(scene.reference, scene.target, config);
  ASSERT_GE(free.rounds.size(), 2U);
  // So many are wanted that the direction with fewer tracks cannot spare the patch's in the second round.
  const int forward = free.rounds[0].forward.homography.ransac_inliers;
  const int backward = free.rounds[0].backward.homography.ransac_inliers;
  const auto scarce = forward < backward ? &MotionRound::forward : &MotionRound::backward;
  config.min_tracks = std::min(forward, backward);
  const std::vector<Track>& second = (free.rounds[1].*scarce).tracks;
  ASSERT_LT(std::count_if(second.begin(), second.end(), [](const Track& track) { return !track.removed; }),
            config.min_tracks);
  const PaperTrace trace = detect_motion(scene.reference, scene.target, config);
  ASSERT_GE(trace.rounds.size(), 2U);
  EXPECT_FALSE((trace.rounds[1].*scarce).homography.valid);
  EXPECT_EQ((trace.rounds[1].*scarce).homography.matrix, (trace.rounds[0].*scarce).homography.matrix);
  EXPECT_FALSE(trace.mask().empty());
  EXPECT_NE(trace.note.find("keeps the last"), std::string::npos) << trace.note;
}

}  // namespace
}  // namespace stillpoint
