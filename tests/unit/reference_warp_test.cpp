#include "core/motion/stillpoint/reference_warp.hpp"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

RgbdView wall(double depth_m) {
  RgbdView view;
  view.camera.width = 40, view.camera.height = 30;
  view.camera.fx = view.camera.fy = 50.0;
  view.camera.cx = 19.5, view.camera.cy = 14.5;
  view.depth = cv::Mat(30, 40, CV_32FC1, cv::Scalar(depth_m));
  view.gray = cv::Mat(30, 40, CV_32FC1);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) view.gray.at<float>(y, x) = static_cast<float>(3 * x + y);
  return view;
}

TEST(ReferenceWarp, StandingStillShowsTheReferenceItself) {
  const auto view = std::make_shared<const RgbdView>(wall(2.0));
  const ReferenceWarp warp = warp_reference(*view, {view, Pose::Identity()});
  // Rounding may put the outermost pixels a hair outside.
  const cv::Rect inner(1, 1, 38, 28);
  EXPECT_LT(cv::norm(warp.gray(inner), view->gray(inner), cv::NORM_INF), 0.2);
  EXPECT_LT(cv::norm(warp.shift(inner), cv::NORM_INF), 1e-4);
}

TEST(ReferenceWarp, FollowsTheCamerasMotionAtEachDepth) {
  RgbdView current = wall(2.0);
  current.depth.at<float>(10, 10) = 1.0F;
  current.depth.at<float>(10, 20) = 0.0F;
  const auto reference = std::make_shared<const RgbdView>(wall(2.0));
  Pose reference_from_current = Pose::Identity();
  reference_from_current.translation().x() = 0.08;  // 2 px at 2 m, 4 px at 1 m
  const ReferenceWarp warp = warp_reference(current, {reference, reference_from_current});
  EXPECT_NEAR(warp.shift.at<float>(5, 5), 2.0F, 1e-4F);
  EXPECT_NEAR(warp.gray.at<float>(5, 5), reference->gray.at<float>(5, 7), 0.2F);
  EXPECT_NEAR(warp.shift.at<float>(10, 10), 4.0F, 1e-4F);
  EXPECT_NEAR(warp.gray.at<float>(10, 10), reference->gray.at<float>(10, 14), 0.2F);
  EXPECT_TRUE(std::isnan(warp.gray.at<float>(10, 20)));
  EXPECT_TRUE(std::isnan(warp.gray.at<float>(5, 39)));  // outside the reference
}

}  // namespace
}  // namespace stillpoint
