#include "core/inspect/frame_pair.hpp"

#include <gtest/gtest.h>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/odometry/map_id.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "tests/unit/ui/inspect_scene.hpp"

namespace stillpoint::testing {
namespace {

using Point = Eigen::Vector2d;

/// Frame 4 beside frame 5 of the scene: what stands still is 5 px further left in frame 5.
struct TwoFrames {
  TwoFrames() {
    past = scene.run.records[4];
    other.index = 4;
    other.frame = scene.view.reference;
    other.record = &past;
  }

  /// A map point found in both, at these places.
  void add(int point, cv::Point2f there, cv::Point2f here, FeatureFate fate = FeatureFate::inlier) {
    scene.add_feature(here, fate, point);
    past.features.push_back(
        {there, static_cast<float>(InspectScene::kDepth), 0.0F, point, std::uint8_t{0}, FeatureFate::inlier});
  }

  [[nodiscard]] FramePair pair() const { return pair_frames(scene.view, other, scene.camera); }

  InspectScene scene;
  FrameRecord past;
  FrameView other;
};

TEST(FramePairs, HoldAMapPointAgainstWhereItWouldBeHadItStoodStill) {
  TwoFrames frames;
  frames.add(7, {80, 50}, {75, 50});
  frames.add(8, {60, 40}, {58, 44}, FeatureFate::outlier);  // 3 px to the right and 4 down
  const FramePair pair = frames.pair();
  ASSERT_EQ(pair.features.size(), 2U);
  EXPECT_NEAR(pair.features[0].error().value(), 0.0, 1e-6);
  EXPECT_TRUE(pair.features[0].inlier);
  EXPECT_NEAR(pair.features[1].error().value(), 5.0, 1e-6);
  EXPECT_FALSE(pair.features[1].inlier);
  EXPECT_NEAR((pair.features[1].expected.value() - Point(55, 40)).norm(), 0.0, 1e-6);
  EXPECT_NEAR(pair.median_error().value(), 5.0, 1e-6);
  EXPECT_NEAR(pair.baseline_m.value(), InspectScene::kStep, 1e-9);
  EXPECT_NEAR(pair.rotation_deg.value(), 0.0, 1e-9);
}

TEST(FramePairs, CountWhatOneFrameAloneFound) {
  TwoFrames frames;
  frames.add(7, {80, 50}, {75, 50});
  frames.scene.add_feature({10, 10}, FeatureFate::inlier, 11);
  frames.scene.add_feature({12, 10}, FeatureFate::unmatched);
  frames.past.features.push_back({{5, 5}, 2.0F, 0.0F, 12, std::uint8_t{0}, FeatureFate::inlier});
  const FramePair pair = frames.pair();
  EXPECT_EQ(pair.features.size(), 1U);
  EXPECT_EQ(pair.only_here, 1);
  EXPECT_EQ(pair.only_other, 1);
}

TEST(FramePairs, ExpectNothingWithoutDepthOrPose) {
  TwoFrames frames;
  frames.add(7, {80, 50}, {75, 50});
  frames.past.features.front().depth = 0.0F;
  FramePair pair = frames.pair();
  ASSERT_EQ(pair.features.size(), 1U);
  EXPECT_FALSE(pair.features[0].error());
  EXPECT_FALSE(pair.median_error());
  frames.past.features.front().depth = 2.0F;
  frames.past.estimated = false;
  pair = frames.pair();
  ASSERT_EQ(pair.features.size(), 1U);
  EXPECT_FALSE(pair.features[0].error());
  EXPECT_FALSE(pair.here_from_other);
  EXPECT_FALSE(pair.baseline_m);
  frames.other.record = nullptr;
  EXPECT_TRUE(frames.pair().features.empty());
}

TEST(EpipolarCurve, RunsFromTheNearestPlaceToInfinity) {
  const TwoFrames frames;
  Pose here_from_other = Pose::Identity();
  here_from_other.translation().x() = -InspectScene::kStep;
  const auto curve = epipolar_curve(frames.scene.camera, here_from_other, {80, 50}, 0.0);
  ASSERT_GT(curve.size(), 10U);
  // A step of 0.1 m moves what is 0.2 m away by 50 px, and what is infinitely far by none.
  EXPECT_NEAR((curve.front() - Point(30, 50)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((curve.back() - Point(80, 50)).norm(), 0.0, 1e-6);
  for (std::size_t i = 1; i < curve.size(); ++i) EXPECT_GT(curve[i].x(), curve[i - 1].x());
}

TEST(EpipolarCurve, EndsWithTheImageAndWhereThePointWouldBeBehindTheCamera) {
  const TwoFrames frames;
  Pose forward = Pose::Identity();
  forward.translation().z() = -1.0;  // the camera went 1 m towards what it sees
  const auto curve = epipolar_curve(frames.scene.camera, forward, {84.5, 59.5}, 0.0);
  ASSERT_FALSE(curve.empty());
  for (const Point& place : curve) {
    EXPECT_GE(place.x(), 84.5 - 1e-6);  // away from the epipole, which is the middle
    EXPECT_LE(place.x(), InspectScene::kWidth - 1.0);
    EXPECT_NEAR(place.y(), 59.5, 1e-6);
  }
  EXPECT_FALSE(pixel_at_depth(frames.scene.camera, forward, {84.5, 59.5}, 0.9));
  EXPECT_NEAR(pixel_at_depth(frames.scene.camera, forward, {84.5, 59.5}, 2.0).value().x(), 89.5, 1e-6);
}

TEST(EpipolarCurve, HoldsThePlaceThatDepthTellsThroughALens) {
  Camera camera = camera_by_name("freiburg1");
  Pose motion = Pose::Identity();
  motion.translation() = Eigen::Vector3d(0.05, -0.02, 0.01);
  const Point pixel(100, 80);
  const auto curve = epipolar_curve(camera, motion, pixel);
  const auto place = pixel_at_depth(camera, motion, pixel, 1.5);
  ASSERT_TRUE(place);
  double nearest = 1e9;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const Point along = curve[i] - curve[i - 1];
    const double t = std::clamp((*place - curve[i - 1]).dot(along) / along.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (curve[i - 1] + t * along - *place).norm());
  }
  EXPECT_LT(nearest, 0.05);
}

}  // namespace
}  // namespace stillpoint::testing
