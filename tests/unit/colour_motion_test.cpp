#include "core/motion/epipolar/colour_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "core/config.hpp"
#include "core/error.hpp"
#include "core/geometry/se3.hpp"
#include "core/motion/epipolar/relative_orientation.hpp"

namespace stillpoint {
namespace {

constexpr int kWidth = 640, kHeight = 480;

/// Smooth random colours: something to follow everywhere, nothing that repeats.
cv::Mat texture(cv::Size size, unsigned seed, double blur) {
  cv::Mat image(size, CV_8UC3);
  cv::RNG random(seed);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(image, image, {0, 0}, blur);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

/// A picture that a camera pans over, with a patch of another texture that goes its own way.
struct Scene {
  cv::Point2f pan{3.0F, 1.0F};    ///< px a frame
  cv::Point2f walk{-4.0F, 2.0F};  ///< px a frame, of the patch in the image
  bool has_patch = true;
  int blur_px = 0;  ///< length of motion blur along x
  cv::Mat ground = texture({1000, 720}, 3, 2.5), patch = texture({130, 200}, 7, 2.0);

  [[nodiscard]] cv::Rect patch_at(int frame) const {
    return {cvRound(400 + walk.x * static_cast<float>(frame)),
            cvRound(140 + walk.y * static_cast<float>(frame)), patch.cols, patch.rows};
  }
  [[nodiscard]] cv::Mat frame(int index) const {
    const cv::Point at(cvRound(60 + pan.x * static_cast<float>(index)),
                       cvRound(60 + pan.y * static_cast<float>(index)));
    cv::Mat image = ground(cv::Rect(at, cv::Size(kWidth, kHeight))).clone();
    if (has_patch) patch.copyTo(image(patch_at(index)));
    if (blur_px > 0) cv::blur(image, image, {blur_px, 1});
    return image;
  }
  [[nodiscard]] cv::Mat truth(int index) const {
    cv::Mat mask = cv::Mat::zeros(kHeight, kWidth, CV_8UC1);
    if (has_patch) mask(patch_at(index)).setTo(255);
    return mask;
  }
};

Camera camera() {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  return camera;
}

EpipolarTrace last_of(const Scene& scene, int frames) {
  ColourMotionDetector detector(camera(), EpipolarConfig{});
  EpipolarTrace trace;
  for (int i = 0; i < frames; ++i) trace = detector.next(scene.frame(i));
  return trace;
}

double share(const cv::Mat& part, const cv::Mat& whole) {
  return static_cast<double>(cv::countNonZero(part)) / std::max(1, cv::countNonZero(whole));
}

void expect_found(const Scene& scene, int frames) {
  const EpipolarTrace trace = last_of(scene, frames);
  ASSERT_EQ(trace.mask.size(), cv::Size(kWidth, kHeight));
  ASSERT_EQ(trace.mask.type(), CV_8UC1);
  const cv::Mat truth = scene.truth(frames - 1);
  EXPECT_GT(share(trace.mask & truth, truth), 0.6);
  EXPECT_LT(share(trace.mask & ~truth, ~truth), 0.02);
  EXPECT_NEAR(trace.mask_share, share(trace.mask, cv::Mat::ones(truth.size(), CV_8UC1)), 1e-9);
  EXPECT_FALSE(trace.regions.empty());
}

TEST(ColourMotion, FindsAPatchThatGoesItsOwnWay) { expect_found({}, 8); }

TEST(ColourMotion, FindsItBeforeACameraAtRest) {
  Scene scene;
  scene.pan = {0, 0};
  expect_found(scene, 8);
}

TEST(ColourMotion, FindsASlowOne) {
  Scene scene;
  scene.pan = {0, 0};
  scene.walk = {1.0F, 0.5F};
  expect_found(scene, 12);
}

TEST(ColourMotion, FindsItThroughBlur) {
  Scene scene;
  scene.blur_px = 9;
  expect_found(scene, 8);
}

TEST(ColourMotion, IsEmptyWhereNothingMoves) {
  for (const cv::Point2f pan : {cv::Point2f(0, 0), cv::Point2f(3, 1), cv::Point2f(-9, 4)})
    for (const int blur_px : {0, 9}) {
      Scene scene;
      scene.has_patch = false;
      scene.pan = pan;
      scene.blur_px = blur_px;
      if (pan.x < 0) scene.ground = texture({1000, 720}, 5, 2.5)(cv::Rect(0, 0, 1000, 720));
      ColourMotionDetector detector(camera(), EpipolarConfig{});
      for (int i = 0; i < 7; ++i) {
        const int at = pan.x < 0 ? 6 - i : i;  // the same way, the other way round
        Scene forward = scene;
        forward.pan = {std::abs(pan.x), pan.y};
        EXPECT_EQ(cv::countNonZero(detector.next(forward.frame(at)).mask), 0) << pan << blur_px << " " << i;
      }
    }
}

TEST(ColourMotion, ParallaxIsNoMotion) {
  // The camera goes sideways: what is near shifts more than what is far, along the same lines.
  Scene scene;
  scene.pan = {2.0F, 0.0F};
  scene.walk = {-6.0F, 0.0F};
  const cv::Mat between = texture({900, 120}, 11, 2.0);
  ColourMotionDetector detector(camera(), EpipolarConfig{});
  for (int i = 0; i < 10; ++i) {
    cv::Mat image = scene.frame(i);
    between(cv::Rect(20 + 4 * i, 0, kWidth, 120)).copyTo(image(cv::Rect(0, 360, kWidth, 120)));
    EXPECT_LT(share(detector.next(image).mask, cv::Mat::ones(kHeight, kWidth, CV_8UC1)), 0.01) << i;
  }
}

TEST(ColourMotion, ACopyGoesOnWithTheSameBytesWhateverTheThreads) {
  const Scene scene;
  Camera rolling = camera();
  rolling.readout_s = 0.03;
  ColourMotionDetector one(rolling, EpipolarConfig{});
  for (int i = 0; i < 5; ++i) (void)one.next(scene.frame(i), i / 30.0);
  ColourMotionDetector other = one;
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const EpipolarTrace a = one.next(scene.frame(5), 5 / 30.0);
  cv::setNumThreads(4);
  const EpipolarTrace b = other.next(scene.frame(5), 5 / 30.0);
  cv::setNumThreads(threads);
  EXPECT_EQ(cv::norm(a.mask, b.mask, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(a.evidence, b.evidence, cv::NORM_INF), 0.0);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) EXPECT_EQ(a.points[i].shared, b.points[i].shared);
}

TEST(ColourMotion, SaysWhatIsWrong) {
  ColourMotionDetector detector(camera(), EpipolarConfig{});
  EXPECT_THROW((void)detector.next(cv::Mat()), InputError);
  EXPECT_THROW((void)detector.next(cv::Mat::zeros(480, 640, CV_32FC1)), InputError);
  const EpipolarTrace tiny = detector.next(cv::Mat::zeros(20, 30, CV_8UC1));
  EXPECT_TRUE(tiny.mask.empty());
  EXPECT_NE(tiny.note.find("30x20"), std::string::npos);
  const EpipolarTrace blank = detector.next(cv::Mat::zeros(480, 640, CV_8UC1));
  EXPECT_EQ(cv::countNonZero(blank.mask), 0);
  EXPECT_TRUE(blank.points.empty());
  EXPECT_FALSE(blank.note.empty());
}

TEST(ColourMotion, AnotherSizeBeginsAnew) {
  const Scene scene;
  ColourMotionDetector detector(camera(), EpipolarConfig{});
  for (int i = 0; i < 3; ++i) (void)detector.next(scene.frame(i));
  cv::Mat half;
  cv::resize(scene.frame(3), half, {320, 240});
  const EpipolarTrace trace = detector.next(half);
  EXPECT_TRUE(trace.references.empty());
  EXPECT_EQ(trace.mask.size(), half.size());
}

/// Points of a room seen from two places, and some that have moved meanwhile.
std::vector<BearingPair> room(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation,
                              int moving) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> wide(-0.6, 0.6), far(1.0, 5.0);
  std::vector<BearingPair> pairs;
  for (int i = 0; i < 300; ++i) {
    const double depth = far(random);
    const Eigen::Vector3d now(wide(random), wide(random), 1.0);
    Eigen::Vector3d then = rotation * (depth * now) + translation;
    if (i < moving) then += Eigen::Vector3d(0.02, 0.09, 0.0) * depth;
    pairs.push_back({now, then / then.z(), 1.0});
  }
  return pairs;
}

TEST(RelativeOrientation, FindsRotationAndDirectionAmongMovers) {
  const Eigen::Matrix3d rotation = so3_exp({0.01, -0.05, 0.02});
  for (const Eigen::Vector3d& translation :
       {Eigen::Vector3d(0.1, 0.01, 0.02), Eigen::Vector3d(-0.02, 0.08, 0.01),
        Eigen::Vector3d(0.01, 0.0, 0.1)}) {
    const std::vector<BearingPair> pairs = room(rotation, translation, 90);
    const RelativeOrientation motion = estimate_relative_orientation(pairs, {});
    EXPECT_FALSE(motion.rotation_only);
    EXPECT_LT(rotation_angle(motion.rotation.transpose() * rotation), 2e-3);
    EXPECT_GT(motion.direction.dot(translation.normalized()), 0.995);
    EXPECT_GT(motion.explained, 0.65);
    for (std::size_t i = 90; i < pairs.size(); ++i)
      EXPECT_LT(epipolar_residual(motion, pairs[i], 1e-3).norm(), 2e-3) << i;
    EXPECT_GT(epipolar_residual(motion, pairs[0], 1e-3).norm(), 5e-3);
  }
}

TEST(RelativeOrientation, KnowsACameraThatOnlyTurns) {
  const Eigen::Matrix3d rotation = so3_exp({0.0, 0.04, 0.0});
  const RelativeOrientation motion =
      estimate_relative_orientation(room(rotation, Eigen::Vector3d::Zero(), 90), {});
  EXPECT_TRUE(motion.rotation_only);
  EXPECT_LT(rotation_angle(motion.rotation.transpose() * rotation), 1e-4);
  EXPECT_NEAR(motion.explained, 0.7, 1e-9);
}

TEST(RelativeOrientation, OfNothingIsRest) {
  const RelativeOrientation motion = estimate_relative_orientation({}, {});
  EXPECT_TRUE(motion.rotation.isIdentity());
  EXPECT_EQ(motion.explained, 0.0);
}

}  // namespace
}  // namespace stillpoint
