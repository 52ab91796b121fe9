// What methods that test scene flow share: rays, residual motion and its covariance, and the pose solved
// again.
#include "core/motion/residual_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "core/motion/feature_pose.hpp"

namespace stillpoint {
namespace {

TEST(PixelRays, OfSmallPixelsLieInTheMiddleOfTheirBlocks) {
  const Camera camera;  // 525 px, centre (319.5, 239.5)
  const PixelRays rays(camera, {640, 480}, 2);
  EXPECT_EQ(rays.size(), cv::Size(320, 240));
  // Small pixel (0, 0) lies about (0.5, 0.5): (0.5 - 319.5) / 525.
  EXPECT_NEAR(rays.at(0, 0).x(), -319.0 / 525.0, 1e-6);
  EXPECT_NEAR(rays.at(0, 0).y(), -239.0 / 525.0, 1e-6);
  // A quarter of a small pixel is half a pixel.
  EXPECT_NEAR(rays.at(10.25F, 4).x() - rays.at(10, 4).x(), 0.5 / 525.0, 1e-6);
  // A frame of half the size has half the focal length: in the same small pixels the rays are twice as far
  // apart.
  EXPECT_NEAR(PixelRays(camera, {320, 240}, 2).at(11, 4).x() - PixelRays(camera, {320, 240}, 2).at(10, 4).x(),
              2.0 * 2.0 / 525.0, 1e-6);
}

TEST(PixelRays, UndoDistortion) {
  const Camera camera = camera_by_name("freiburg1");
  const PixelRays rays(camera, {640, 480}, 2);
  for (const cv::Point& small : {cv::Point(3, 5), cv::Point(160, 120), cv::Point(310, 200)}) {
    const Eigen::Vector2d straight = camera.undistorted({2.0 * small.x + 0.5, 2.0 * small.y + 0.5});
    const Eigen::Vector2f ray = rays.at(static_cast<float>(small.x), static_cast<float>(small.y));
    EXPECT_NEAR(ray.x(), (straight.x() - camera.cx) / camera.fx, 1e-5);
    EXPECT_NEAR(ray.y(), (straight.y() - camera.cy) / camera.fy, 1e-5);
    const Eigen::Vector2f next = rays.at(static_cast<float>(small.x) + 1.0F, static_cast<float>(small.y));
    EXPECT_NEAR(rays.at(static_cast<float>(small.x) + 0.5F, static_cast<float>(small.y)).x(),
                0.5F * (ray.x() + next.x()), 1e-6);
  }
}

TEST(ResidualMotion, CovarianceOfAPointByHand) {
  // σ_z = 1e-3 * 2² = 4 mm along (0.5, -0.25, 1); 2 * 0.002 = 4 mm across and 2 * 0.003 = 6 mm down.
  const Eigen::Matrix3f covariance = point_covariance({0.5F, -0.25F}, 2.0F, {0.002, 0.003, 1e-3, 0.0});
  Eigen::Matrix3f by_hand;
  by_hand << 4e-6F + 16e-6F, -2e-6F, 8e-6F, -2e-6F, 1e-6F + 36e-6F, -4e-6F, 8e-6F, -4e-6F, 16e-6F;
  EXPECT_LT((covariance - by_hand).cwiseAbs().maxCoeff(), 1e-10F);
  // With a floor of 3 mm the depth is off by 5 mm: 25 instead of 16.
  const Eigen::Matrix3f floored = point_covariance({0.5F, -0.25F}, 2.0F, {0.002, 0.003, 1e-3, 3e-3});
  EXPECT_NEAR(floored(2, 2), 25e-6, 1e-10);
  EXPECT_NEAR(floored(0, 2), 12.5e-6, 1e-10);
  EXPECT_NEAR(floored(1, 1), 25e-6 / 16 + 36e-6, 1e-10);
}

TEST(ResidualMotion, IsWhatTheCamerasMotionLeaves) {
  // A quarter turn about the optical axis takes (x, y) to (-y, x).
  Pose here_from_last = Pose::Identity();
  here_from_last.linear() = so3_exp({0, 0, CV_PI / 2});
  here_from_last.translation() = Eigen::Vector3d(0.1, 0.2, -0.5);
  // (0.5, 0.25, 1) * 2 = (1, 0.5, 2) comes to (-0.4, 1.2, 1.5). It is seen at (-0.2, 0.8, 1) * 1.6.
  const ScenePair pair{{0.5F, 0.25F}, {-0.2F, 0.8F}, 2.0F, 1.6F};
  const SceneFlowNoise noise{0.002, 0.003, 1e-3, 0.0};
  const ResidualMotion residual = residual_motion(pair, CameraMotion(here_from_last), noise);
  EXPECT_NEAR(residual.motion.x(), -0.32 + 0.4, 1e-6);
  EXPECT_NEAR(residual.motion.y(), 1.28 - 1.2, 1e-6);
  EXPECT_NEAR(residual.motion.z(), 1.6 - 1.5, 1e-6);
  // What was across is down now: the last point's covariance has x and y in each other's place.
  const Eigen::Matrix3f here = point_covariance(pair.ray_here, 1.6F, noise),
                        last = point_covariance(pair.ray_last, 2.0F, noise);
  EXPECT_NEAR(residual.covariance(0, 0), here(0, 0) + last(1, 1), 1e-10);
  EXPECT_NEAR(residual.covariance(1, 1), here(1, 1) + last(0, 0), 1e-10);
  EXPECT_NEAR(residual.covariance(0, 1), here(0, 1) - last(0, 1), 1e-10);
  EXPECT_NEAR(residual.covariance(0, 2), here(0, 2) - last(1, 2), 1e-10);
}

TEST(ResidualMotion, CovarianceIsJSJByDifferences) {
  // All nine or so measurements and the pose, each moved a little: an independent Jacobian.
  Vector6d motion;
  motion << 0.05, -0.02, 0.08, 0.1, -0.2, 0.15;
  const Pose here_from_last = se3_exp(motion);
  const Eigen::Vector3d seen_last(0.3, -0.4, 1.7), seen_here(0.25, -0.3, 1.8);  // ray x, y and depth
  const auto residual = [&](const Eigen::Matrix<double, 12, 1>& off) -> Eigen::Vector3d {
    const Eigen::Vector3d a = seen_here + off.segment<3>(0), b = seen_last + off.segment<3>(3);
    const Eigen::Vector3d here(a.x() * a.z(), a.y() * a.z(), a.z()),
        last(b.x() * b.z(), b.y() * b.z(), b.z());
    return here - se3_exp(off.tail<6>()) * here_from_last * last;
  };
  Eigen::Matrix<double, 3, 12> jacobian;
  for (int i = 0; i < 12; ++i) {
    Eigen::Matrix<double, 12, 1> step = Eigen::Matrix<double, 12, 1>::Zero();
    step[i] = 1e-5;
    jacobian.col(i) = (residual(step) - residual(-step)) / 2e-5;
  }
  Matrix6d mix = Matrix6d::Identity() * 0.004;
  mix(0, 4) = 0.001, mix(2, 3) = -0.002, mix(5, 1) = 0.0015;
  const Matrix6d pose_covariance = mix * mix.transpose();
  const SceneFlowNoise noise{0.001, 0.0012, 1.425e-3, 0.0};
  Eigen::Matrix<double, 12, 12> s = Eigen::Matrix<double, 12, 12>::Zero();
  s.diagonal().head<6>() << 1e-6, 1.44e-6, std::pow(1.425e-3 * 1.8 * 1.8, 2), 1e-6, 1.44e-6,
      std::pow(1.425e-3 * 1.7 * 1.7, 2);
  s.bottomRightCorner<6, 6>() = pose_covariance;
  const Eigen::Matrix3d expected = jacobian * s * jacobian.transpose();
  const ScenePair pair{{0.3F, -0.4F}, {0.25F, -0.3F}, 1.7F, 1.8F};
  const ResidualMotion found = residual_motion(pair, CameraMotion(here_from_last, pose_covariance), noise);
  EXPECT_LT((found.covariance.cast<double>() - expected).norm() / expected.norm(), 1e-4);
  EXPECT_LT((found.motion.cast<double>() - residual(Eigen::Matrix<double, 12, 1>::Zero())).norm(), 1e-6);
  const Eigen::Vector3d m = found.motion.cast<double>();
  EXPECT_NEAR(found.chi_squared(), m.dot(expected.inverse() * m), 1e-3 * m.dot(expected.inverse() * m));
}

TEST(ResidualMotion, ChiSquaredAndSigmaByHand) {
  ResidualMotion residual;
  residual.covariance = Eigen::Vector3f(4e-6F, 9e-6F, 16e-6F).asDiagonal();
  residual.motion = {0.004F, 0.009F, 0.0F};
  EXPECT_NEAR(residual.chi_squared(), 4.0 + 9.0, 1e-4);  // two and three sigma
  // sqrt((16e-6 * 4e-6 + 81e-6 * 9e-6) / 97e-6)
  EXPECT_NEAR(residual.sigma(), std::sqrt((16.0 * 4.0 + 81.0 * 9.0) / 97.0) * 1e-3, 1e-8);
  residual.motion.setZero();
  EXPECT_EQ(residual.chi_squared(), 0.0F);
}

TEST(SurfaceDepth, OnlyWithinASurface) {
  cv::Mat depth(5, 7, CV_32FC1, cv::Scalar(2.0));
  EXPECT_EQ(surface_depth(depth, 2.4F, 1.6F), 2.0F);
  EXPECT_EQ(surface_depth(depth, 0.4F, 2.0F), 0.0F);  // at the border
  EXPECT_EQ(surface_depth(depth, 2.0F, 3.6F), 0.0F);
  depth.at<float>(2, 3) = 2.06F;  // within 2 cm + 1.2 % of 4
  EXPECT_EQ(surface_depth(depth, 2.0F, 2.0F), 2.0F);
  depth.at<float>(2, 3) = 2.08F;
  EXPECT_EQ(surface_depth(depth, 2.0F, 2.0F), 0.0F);
  depth.at<float>(2, 3) = 0.0F;  // a hole
  EXPECT_EQ(surface_depth(depth, 2.0F, 2.0F), 0.0F);
  EXPECT_EQ(surface_depth(depth, 3.0F, 2.0F), 0.0F);
  EXPECT_EQ(surface_depth(depth, 5.0F, 2.0F), 2.0F);
}

/// Points before a camera, and where it sees them.
std::vector<MotionFeature> features_at(const Pose& camera_from_world, const Camera& camera) {
  std::vector<MotionFeature> features;
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 8; ++x) {
      MotionFeature feature;
      feature.map_point = 8 * y + x;
      feature.world = {0.35 * (x - 3.5), 0.3 * (y - 2.5), 2.0 + 0.4 * ((3 * x + 5 * y) % 7)};
      const Eigen::Vector2d pixel = camera.project(camera_from_world * feature.world);
      feature.pixel = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
      features.push_back(feature);
    }
  return features;
}

TEST(FeaturePose, FindsTheCameraPastWhatMoves) {
  const Camera camera;
  Vector6d motion;
  motion << 0.03, -0.02, 0.04, 0.01, 0.02, -0.015;
  const Pose truth = se3_exp(motion);
  std::vector<MotionFeature> features = features_at(truth, camera);
  for (std::size_t i = 0; i < features.size(); i += 5)
    features[i].pixel += cv::Point2f(9.0F, -6.0F);  // a fifth
  const FeaturePose pose = pose_of_features(features, {}, Pose::Identity(), camera);
  ASSERT_TRUE(pose.found);
  EXPECT_EQ(pose.used, 48);
  EXPECT_EQ(pose.inliers, 38);
  EXPECT_EQ(pose.is_inlier[5], 0);
  EXPECT_EQ(pose.is_inlier[6], 1);
  EXPECT_LT(se3_log(pose.camera_from_world * truth.inverse()).norm(), 1e-5);
  EXPECT_EQ(pose.sigma_px, 0.5);  // at least
}

TEST(FeaturePose, CovarianceIsTheInverseHessian) {
  const Camera camera;
  const Pose truth = se3_exp(0.02 * Vector6d::Ones());
  const std::vector<MotionFeature> features = features_at(truth, camera);
  const FeaturePose pose = pose_of_features(features, {}, truth, camera);
  Matrix6d hessian = Matrix6d::Zero();
  for (const MotionFeature& feature : features) {
    Eigen::Matrix<double, 2, 6> jacobian;
    for (int i = 0; i < 6; ++i) {
      const Vector6d step = 1e-6 * Vector6d::Unit(i);
      jacobian.col(i) = (camera.project(se3_exp(step) * truth * feature.world) -
                         camera.project(se3_exp(-step) * truth * feature.world)) /
                        2e-6;
    }
    hessian += jacobian.transpose() * jacobian / 0.25;  // half a pixel's noise
  }
  const Matrix6d expected = hessian.inverse();
  EXPECT_LT((pose.covariance - expected).norm() / expected.norm(), 1e-3);
}

TEST(FeaturePose, LeavesOutWhatItIsToldAndSaysWhenTooLittleIsLeft) {
  const Camera camera;
  std::vector<MotionFeature> features = features_at(Pose::Identity(), camera);
  std::vector<std::uint8_t> left_out(features.size(), 1);
  for (std::size_t i = 0; i < 11; ++i) left_out[4 * i] = 0;
  const Pose start = se3_exp(0.01 * Vector6d::Ones());
  const FeaturePose few = pose_of_features(features, left_out, start, camera);
  EXPECT_FALSE(few.found);
  EXPECT_EQ(few.used, 11);
  EXPECT_TRUE(few.camera_from_world.isApprox(start));
  EXPECT_EQ(few.covariance.norm(), 0.0);
  EXPECT_TRUE(few.is_inlier.empty());
  left_out[47] = 0;
  EXPECT_TRUE(pose_of_features(features, left_out, start, camera).found);
  features[47].map_point = -1;  // no point to go by
  EXPECT_EQ(pose_of_features(features, left_out, start, camera).used, 11);
}

}  // namespace
}  // namespace stillpoint
