// Sparse direct alignment: against exact poses of rendered frames, and within odometry where corners starve.
#include "core/odometry/direct_alignment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "tests/support/rendered.hpp"

namespace stillpoint {
namespace {

/// Two frames of a generated sequence, and how they truly lie to each other.
struct FramePair {
  FramePair(const char* kind, int from, int to) {
    const auto source = rendered(kind, to + 1);
    camera = source->camera();
    const Frame frame = source->read(from), later = source->read(to);
    reference.gray = frame.gray.clone(), reference.depth = frame.depth.clone();
    target.gray = later.gray.clone(), target.depth = later.depth.clone();
    truth = source->truth(to).world_from_camera->inverse() * *source->truth(from).world_from_camera;
  }

  [[nodiscard]] DirectAlignment align(const Pose& start = Pose::Identity()) const {
    return align_directly(reference, target, {start}, camera, {});
  }
  /// px, the most that the pose puts a point 2 m away beside where it truly lies.
  [[nodiscard]] double error_px(const Pose& target_from_reference) const {
    double worst = 0.0;
    for (const double x : {40.0, 320.0, 600.0})
      for (const double y : {40.0, 240.0, 440.0}) {
        const Eigen::Vector3d point = camera.back_project({x, y}, 2.0);
        worst = std::max(
            worst, (camera.project(target_from_reference * point) - camera.project(truth * point)).norm());
      }
    return worst;
  }

  Camera camera;
  DirectReference reference;
  DirectTarget target;
  Pose truth = Pose::Identity();
};

TEST(DirectAlignment, IsExactToAFractionOfAPixel) {
  const FramePair pair("room", 4, 10);
  ASSERT_GT(pair.error_px(Pose::Identity()), 10.0);  // there is something to find
  const DirectAlignment aligned = pair.align();
  EXPECT_TRUE(aligned.record.believed);
  EXPECT_LT(pair.error_px(aligned.target_from_reference), 0.5);
  EXPECT_GT(aligned.record.patches, 300);
  EXPECT_GT(aligned.record.correlation, 0.9);
  EXPECT_GT(aligned.record.agreement, 0.9);
  EXPECT_LT(aligned.record.rms_after, 0.5 * aligned.record.rms_before);
}

TEST(DirectAlignment, FindsGainAndBiasOfBrightness) {
  FramePair pair("room", 4, 6);
  pair.target.gray.convertTo(pair.target.gray, CV_8U, 0.8, 12.0);
  const DirectAlignment aligned = pair.align();
  EXPECT_TRUE(aligned.record.believed);
  EXPECT_NEAR(aligned.gain, 0.8, 0.03);
  EXPECT_NEAR(aligned.bias, 12.0, 4.0);
  EXPECT_LT(pair.error_px(aligned.target_from_reference), 0.5);
}

TEST(DirectAlignment, HoldsWhereAJerkBlursTheFrame) {
  // A frame as a camera sees it that turns by 4 degrees while it exposes: 40 px of blur about the middle.
  FramePair blurred("room", 4, 6);
  cv::Mat kernel = cv::Mat::zeros(41, 41, CV_32FC1);
  kernel.row(20).setTo(1.0 / 41.0);
  cv::filter2D(blurred.target.gray, blurred.target.gray, -1, kernel);
  const DirectAlignment aligned = blurred.align();
  EXPECT_TRUE(aligned.record.believed);
  EXPECT_LT(blurred.error_px(aligned.target_from_reference), 2.0);
}

TEST(DirectAlignment, FindsATurnThatNoPredictionKnewOf) {
  FramePair pair("room", 4, 5);
  // The target seen through a lens turned aside by 5 degrees, half the width of what the coarse search
  // covers.
  const Eigen::Matrix3d turn = so3_exp({0.02, 0.0873, 0.0});
  const cv::Matx33d k = pair.camera.matrix();
  cv::Matx33d r;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) r(row, column) = turn(row, column);
  cv::warpPerspective(pair.target.gray, pair.target.gray, k * r * k.inv(), pair.target.gray.size());
  pair.target.depth.release();
  pair.truth.prerotate(turn);
  ASSERT_GT(pair.error_px(Pose::Identity()), 45.0);
  const DirectAlignment aligned = pair.align();
  EXPECT_TRUE(aligned.record.believed);
  EXPECT_LT(pair.error_px(aligned.target_from_reference), 1.0);
}

TEST(DirectAlignment, LeavesOutWhatMovesInEitherFrame) {
  FramePair pair("room", 4, 6);
  const cv::Rect before(100, 100, 180, 200), now(360, 60, 200, 240);
  cv::Mat mask = cv::Mat::zeros(pair.reference.gray.size(), CV_8UC1);
  mask(before).setTo(255);
  pair.reference.moving = small_mask(mask);
  for (const PatchPoint& patch : choose_patches(pair.reference, pair.camera, false, 16))
    EXPECT_FALSE(cv::Rect2f(before).contains(patch.pixel)) << patch.pixel;
  mask.setTo(0);
  mask(now).setTo(255);
  pair.target.moving = small_mask(mask);
  const DirectAlignment aligned = pair.align();
  EXPECT_TRUE(aligned.record.believed);
  for (const DirectPatch& patch : *aligned.record.seen)
    EXPECT_FALSE(cv::Rect2f(now).contains(patch.pixel)) << patch.pixel;
  // What the masks hide has no say: another picture there changes nothing.
  FramePair other = pair;
  other.reference.gray = pair.reference.gray.clone(), other.target.gray = pair.target.gray.clone();
  other.reference.gray(before - cv::Size(80, 80) + cv::Point(40, 40)).setTo(0);
  other.target.gray(now - cv::Size(80, 80) + cv::Point(40, 40)).setTo(255);
  EXPECT_NEAR(other.error_px(other.align().target_from_reference),
              pair.error_px(aligned.target_from_reference), 0.1);
}

TEST(DirectAlignment, DoesNotBelieveWhatIsNotAlike) {
  FramePair pair("room", 4, 6);
  cv::flip(pair.target.gray, pair.target.gray, 0);
  cv::flip(pair.target.depth, pair.target.depth, 0);
  EXPECT_FALSE(pair.align().record.believed);
  pair.target.gray.setTo(90);
  EXPECT_FALSE(pair.align().record.believed);
  pair.reference.gray.setTo(90);  // nothing to lay anywhere
  const DirectAlignment aligned = pair.align();
  EXPECT_FALSE(aligned.record.believed);
  EXPECT_EQ(aligned.record.patches, 0);
}

TEST(DirectAlignment, DoesNotBelieveAViewAtOtherDepths) {
  FramePair pair("room", 4, 6);
  ASSERT_TRUE(pair.align().record.believed);
  pair.target.depth *= 1.3;
  EXPECT_FALSE(pair.align().record.believed);
}

TEST(DirectAlignment, ASmallMaskCoversWhateverTheMaskDoes) {
  cv::Mat mask = cv::Mat::zeros(48, 64, CV_8UC1);
  mask.at<std::uint8_t>(13, 22) = 255;  // one pixel of its block of sixteen
  const cv::Mat small = small_mask(mask);
  EXPECT_EQ(cv::countNonZero(small), 1);
  EXPECT_TRUE(covers(small, {22, 13}));
  EXPECT_FALSE(covers(small, {19, 13}));
  EXPECT_FALSE(covers(small, {-1, 500}));
  EXPECT_TRUE(small_mask({}).empty());
  EXPECT_FALSE(covers({}, {3, 3}));
}

}  // namespace
}  // namespace stillpoint
