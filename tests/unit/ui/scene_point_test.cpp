#include "core/inspect/scene_point.hpp"

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

PairGeometry pair_of(const InspectScene& scene) { return pair_geometry(scene.view, scene.run, scene.camera); }

void expect_near(const std::optional<WarpedPoint>& carried, const Point& pixel, WarpedBy by) {
  ASSERT_TRUE(carried);
  EXPECT_NEAR(carried->pixel.x(), pixel.x(), 1e-3);
  EXPECT_NEAR(carried->pixel.y(), pixel.y(), 1e-3);
  EXPECT_EQ(carried->by, by);
}

TEST(ScenePoint, IsWhereTheCamerasMotionAndDepthPutIt) {
  const InspectScene scene;
  const PairGeometry pair = pair_of(scene);
  // The camera went right by 0.1 m: what is at 2 m was 5 px further right before.
  expect_near(scene_point_in(pair, FrameSpace::kReference, {70, 50}), {75, 50}, WarpedBy::kDepth);
  expect_near(target_point(pair, FrameSpace::kReference, {75, 50}), {70, 50}, WarpedBy::kDepth);
  expect_near(scene_point_in(pair, FrameSpace::kTarget, {70, 50}), {70, 50}, WarpedBy::kItself);
}

TEST(ScenePoint, NearerThanTheHomographysPlaneItIsBesideItselfInTheCompensatedFrame) {
  InspectScene scene;
  // At 1 m parallax is 10 px; the homography takes back 5 of them.
  scene.view.frame.depth.at<float>(50, 70) = 1.0F;
  const PairGeometry pair = pair_of(scene);
  expect_near(scene_point_in(pair, FrameSpace::kReference, {70, 50}), {80, 50}, WarpedBy::kDepth);
  expect_near(scene_point_in(pair, FrameSpace::kCompensatedForward, {70, 50}), {75, 50}, WarpedBy::kDepth);
  expect_near(scene_point_in(pair, FrameSpace::kCompensatedForward, {71, 50}), {71, 50}, WarpedBy::kDepth);
}

TEST(ScenePoint, WithoutDepthOrPoseTheHomographyWarpsIt) {
  InspectScene scene;
  scene.view.frame.depth.at<float>(50, 70) = 0.0F;
  PairGeometry pair = pair_of(scene);
  expect_near(scene_point_in(pair, FrameSpace::kReference, {70, 50}), {75, 50}, WarpedBy::kHomography);
  expect_near(scene_point_in(pair, FrameSpace::kCompensatedForward, {70, 50}), {70, 50},
              WarpedBy::kHomography);
  scene.run.records.change(4, [](FrameRecord& record) { record.estimated = false; });
  pair = pair_of(scene);
  EXPECT_FALSE(pair.reference_from_target);
  expect_near(target_point(pair, FrameSpace::kReference, {75, 50}), {70, 50}, WarpedBy::kHomography);
  pair.backward.reset();  // then the other direction's, backwards
  expect_near(scene_point_in(pair, FrameSpace::kReference, {70, 50}), {75, 50}, WarpedBy::kHomography);
  pair.forward.reset();
  EXPECT_FALSE(scene_point_in(pair, FrameSpace::kReference, {70, 50}));
  EXPECT_FALSE(scene_point_in(pair, FrameSpace::kCompensatedForward, {70, 50}));
  EXPECT_FALSE(scene_point_in(pair, FrameSpace::kCompensatedBackward, {70, 50}));
}

TEST(ScenePoint, ComesBackFromEverySpace) {
  const InspectScene scene;
  PairGeometry pair = pair_of(scene);
  pair.camera.k1 = 0.05;
  for (const FrameSpace space : {FrameSpace::kTarget, FrameSpace::kReference, FrameSpace::kCompensatedForward,
                                 FrameSpace::kCompensatedBackward, FrameSpace::kSmall})
    for (const Point& target : {Point(40, 30), Point(80.5, 60.25), Point(120, 100)}) {
      const auto there = scene_point_in(pair, space, target);
      ASSERT_TRUE(there);
      const auto back = target_point(pair, space, there->pixel);
      ASSERT_TRUE(back);
      EXPECT_LT((back->pixel - target).norm(), 0.01) << static_cast<int>(space);
    }
}

TEST(ScenePoint, SmallPixelsCoverFactorTimesFactorPixels) {
  const InspectScene scene;
  PairGeometry pair = pair_of(scene);
  pair.small_factor = 4;
  // Pixels 8 to 11 make small pixel 2, whose middle is between 9 and 10.
  expect_near(scene_point_in(pair, FrameSpace::kSmall, {9.5, 9.5}), {2, 2}, WarpedBy::kItself);
  expect_near(target_point(pair, FrameSpace::kSmall, {0, 0}), {1.5, 1.5}, WarpedBy::kItself);
}

TEST(ScenePoint, BehindTheCameraThereIsNone) {
  const InspectScene scene;
  PairGeometry pair = pair_of(scene);
  pair.reference_from_target->translation().z() = -3.0;
  pair.forward.reset();
  pair.backward.reset();
  EXPECT_FALSE(scene_point_in(pair, FrameSpace::kReference, {70, 50}));
}

TEST(ScenePoint, DepthIsReadAtTheNearestPixelInsideTheImage) {
  cv::Mat depth = cv::Mat::zeros(4, 4, CV_32FC1);
  depth.at<float>(2, 1) = 1.5F;
  EXPECT_EQ(depth_at_pixel(depth, {1.4, 1.6}), 1.5);
  EXPECT_FALSE(depth_at_pixel(depth, {0.4, 1.6}));
  EXPECT_FALSE(depth_at_pixel(depth, {-1.0, 2.0}));
  EXPECT_FALSE(depth_at_pixel(depth, {4.0, 2.0}));
  EXPECT_FALSE(depth_at_pixel(depth, {std::nan(""), 2.0}));
  EXPECT_FALSE(depth_at_pixel({}, {1.0, 1.0}));
}

TEST(ScenePoint, LiesWhereItsPixelAndDepthSay) {
  const InspectScene scene;
  const auto point = point_in_camera(pair_of(scene), {129.5, 59.5});
  ASSERT_TRUE(point);
  EXPECT_LT((*point - Eigen::Vector3d(1.0, 0.0, 2.0)).norm(), 1e-6);
}

}  // namespace
}  // namespace stillpoint::testing
