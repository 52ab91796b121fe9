#include <gtest/gtest.h>

#include <numbers>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"

namespace stillpoint {
namespace {

TEST(Se3, ExpAndLogAreInverse) {
  Vector6d xi;
  xi << 0.3, -0.2, 1.1, 0.4, -1.2, 0.7;
  EXPECT_LT((se3_log(se3_exp(xi)) - xi).norm(), 1e-12);
  xi.tail<3>() *= 1e-7;
  EXPECT_LT((se3_log(se3_exp(xi)) - xi).norm(), 1e-12);
  xi.tail<3>() = Eigen::Vector3d(0, std::numbers::pi - 1e-4, 0);
  EXPECT_LT((se3_log(se3_exp(xi)) - xi).norm(), 1e-9);
}

TEST(Se3, QuarterTurnAboutZMovesAlongACircle) {
  // A unit of arc length pi/2 along x while turning pi/2 about z: a circle of radius 1, hence the point (1,
  // 1, 0).
  Vector6d xi;
  xi << std::numbers::pi / 2, 0, 0, 0, 0, std::numbers::pi / 2;
  const Pose pose = se3_exp(xi);
  EXPECT_LT((pose.translation() - Eigen::Vector3d(1, 1, 0)).norm(), 1e-12);
  EXPECT_LT((pose.linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_NEAR(rotation_angle(pose.linear()), std::numbers::pi / 2, 1e-12);
}

TEST(Camera, UndistortAndDistortAreInverse) {
  const Camera camera = camera_by_name("freiburg1");
  for (const cv::Point2f pixel : {cv::Point2f(320, 240), cv::Point2f(60, 50), cv::Point2f(600, 400)}) {
    const auto straight = camera.undistort({pixel});
    const Eigen::Vector2d back = camera.distort({straight[0].x, straight[0].y});
    EXPECT_NEAR(back.x(), pixel.x, 0.05);
    EXPECT_NEAR(back.y(), pixel.y, 0.05);
  }
}

TEST(Camera, FolderNamesTellTheCamera) {
  EXPECT_EQ(camera_from_folder_name("rgbd_dataset_freiburg3_walking_xyz")->name, "freiburg3");
  EXPECT_EQ(camera_from_folder_name("fr1_xyz_clip")->name, "freiburg1");
  EXPECT_EQ(camera_from_folder_name("rgbd_bonn_crowd2")->name, "bonn");
  EXPECT_FALSE(camera_from_folder_name("kitchen"));
}

}  // namespace
}  // namespace stillpoint
