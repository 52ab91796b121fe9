#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <numbers>

#include "core/geometry/camera.hpp"
#include "core/geometry/normal_equations.hpp"
#include "core/geometry/rotation_fit.hpp"
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

/// A wide lens: the left camera of the EuRoC data set.
Camera wide_camera() {
  Camera camera;
  camera.width = 752, camera.height = 480;
  camera.fx = 458.654, camera.fy = 457.296, camera.cx = 367.215, camera.cy = 248.375;
  camera.k1 = -0.28340811, camera.k2 = 0.07395907, camera.p1 = 0.00019359, camera.p2 = 1.76187114e-05;
  return camera;
}

TEST(RotationFit, FindsTheTurnOfThreePointsAndStaysARotationWhereTheyAreMirrored) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  Eigen::Matrix3d from;
  from << 1, 0, -1, 0.2, 1, -1.2, 0.1, -0.4, 0.3;
  const RotationFit fit = fit_rotation(turn * from * from.transpose());
  EXPECT_TRUE(fit.rotation.isApprox(turn, 1e-12));
  EXPECT_GE(fit.singular_values[0], fit.singular_values[1]);
  EXPECT_TRUE(fit.rotation.isApprox(fit.to_axes * fit.from_axes.transpose(), 1e-12) ||
              fit.singular_values[2] < 1e-12 * fit.singular_values[0]);

  Eigen::Matrix3d cube = Eigen::Matrix3d::Identity();
  cube.diagonal() << 3.0, 2.0, 1.0;
  const Eigen::Matrix3d mirror = Eigen::Vector3d(1, 1, -1).asDiagonal();
  const RotationFit mirrored = fit_rotation(mirror * cube);
  EXPECT_TRUE(mirrored.rotation.isIdentity(1e-12));  // the least axis gives way
}

TEST(NormalEquations, ColumnsAreSolvedAsTheyAreAlone) {
  Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Identity() * 2.0;
  h(0, 1) = h(1, 0) = 0.5, h(2, 5) = h(5, 2) = -0.75;
  Eigen::Matrix<double, 6, 1> g;
  g << 1, 2, 3, 4, 5, 6;
  const auto alone = try_solve_ldlt<6>(h, g);
  ASSERT_TRUE(alone);
  EXPECT_LT((h * *alone - g).norm(), 1e-12);
  Eigen::MatrixXd both(6, 2);
  both << g, -2.0 * g;
  EXPECT_LT((solve_ldlt(h, both).col(1) + 2.0 * *alone).norm(), 1e-12);
  EXPECT_FALSE(try_solve_ldlt<6>(h, g * std::numeric_limits<double>::infinity()));
}

TEST(Camera, UndistortAndDistortAreInverseOverTheWholeImage) {
  for (const Camera& camera :
       {camera_by_name("freiburg1"), camera_by_name("freiburg2"), camera_by_name("bonn"), wide_camera()})
    for (int y = 0; y <= camera.height; y += 20)
      for (int x = 0; x <= camera.width; x += 20) {
        const Eigen::Vector2d pixel(x - 0.5, y - 0.5);
        const Eigen::Vector2d straight = camera.undistorted(pixel);
        EXPECT_LT((camera.distort(straight) - pixel).norm(), 1e-6) << camera.name << " " << pixel.transpose();
        const auto single =
            camera.undistort({{static_cast<float>(pixel.x()), static_cast<float>(pixel.y())}});
        EXPECT_LT((Eigen::Vector2d(single[0].x, single[0].y) - straight).norm(), 1e-4);
      }
}

TEST(Camera, DistortionIsBrownAndConradys) {
  // By hand: x = 0.5, y = -0.25, r2 = 0.3125.
  Camera camera;
  camera.k1 = 0.1, camera.k2 = -0.2, camera.k3 = 0.3, camera.p1 = 0.01, camera.p2 = -0.02;
  const double radial = 1 + 0.3125 * (0.1 + 0.3125 * (-0.2 + 0.3125 * 0.3));
  const double x = 0.5 * radial + 2 * 0.01 * 0.5 * -0.25 - 0.02 * (0.3125 + 2 * 0.25);
  const double y = -0.25 * radial + 0.01 * (0.3125 + 2 * 0.0625) + 2 * -0.02 * 0.5 * -0.25;
  const Eigen::Vector2d pixel = camera.distort(camera.project({0.5, -0.25, 1.0}));
  EXPECT_NEAR(pixel.x(), 525 * x + 319.5, 1e-9);
  EXPECT_NEAR(pixel.y(), 525 * y + 239.5, 1e-9);
}

TEST(Camera, FolderNamesTellTheCamera) {
  EXPECT_EQ(camera_from_folder_name("rgbd_dataset_freiburg3_walking_xyz")->name, "freiburg3");
  EXPECT_EQ(camera_from_folder_name("fr1_xyz_clip")->name, "freiburg1");
  EXPECT_EQ(camera_from_folder_name("rgbd_bonn_crowd2")->name, "bonn");
  EXPECT_FALSE(camera_from_folder_name("kitchen"));
}

}  // namespace
}  // namespace stillpoint
