#include "core/odometry/consensus.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace stillpoint {
namespace {

const Camera kCamera = camera_by_name("generated");

TEST(Consensus, AMoverRichInFeaturesDoesNotCaptureTheCamera) {
  // 300 points on a near thing that goes with the camera, 150 on the room behind it.
  cv::RNG random(9);
  Pose truth = Pose::Identity();
  truth.translation() = Eigen::Vector3d(0.04, 0.0, 0.01);
  std::vector<PoseObservation> observations;
  for (int i = 0; i < 450; ++i) {
    const bool mover = i < 300;
    PoseObservation o;
    o.depth = mover ? random.uniform(0.6, 0.7) : random.uniform(1.0, 3.5);
    o.pixel = mover ? Eigen::Vector2d(random.uniform(220.0, 420.0), random.uniform(100.0, 460.0))
                    : Eigen::Vector2d(random.uniform(0.0, 640.0), random.uniform(0.0, 480.0));
    const Eigen::Vector3d in_camera = kCamera.back_project(o.pixel, o.depth);
    o.point_in_world = mover ? in_camera : Eigen::Vector3d(truth.inverse() * in_camera);
    o.pixel += Eigen::Vector2d(random.gaussian(0.4), random.gaussian(0.4));
    observations.push_back(o);
  }
  const Pose captured = refine_pose(kCamera, observations, Pose::Identity(), {}).camera_from_world;
  EXPECT_LT(captured.translation().norm(), 0.02) << "least squares follows the many";
  const Consensus consensus = consensus_pose(kCamera, observations, {Pose::Identity(), captured}, 200, 1);
  EXPECT_LT((consensus.camera_from_world.translation() - truth.translation()).norm(), 0.004);
  int mover_inliers = 0;
  for (std::size_t i = 0; i < 300; ++i) mover_inliers += consensus.inlier[i];
  EXPECT_LT(mover_inliers, 30);
  const Consensus again = consensus_pose(kCamera, observations, {Pose::Identity(), captured}, 200, 1);
  EXPECT_EQ(consensus.camera_from_world.matrix(), again.camera_from_world.matrix());
  EXPECT_EQ(consensus_pose(kCamera, {}, {Pose::Identity()}, 10, 1).inliers, 0);
}

TEST(Consensus, AThingThatHoldsMostFeaturesIsNotTheUsualDepth) {
  // It starts slowly: both it and the room are about met by one pose, and two in three features are on it.
  cv::RNG random(5);
  Pose truth = Pose::Identity(), of_board = Pose::Identity();
  of_board.translation().z() = -0.045;
  std::vector<PoseObservation> observations;
  for (int i = 0; i < 460; ++i) {
    const bool board = i < 300;
    PoseObservation o;
    o.depth = board ? 1.8 : random.uniform(3.0, 5.0);
    o.pixel = board ? Eigen::Vector2d(random.uniform(200.0, 420.0), random.uniform(120.0, 480.0))
                    : Eigen::Vector2d(random.uniform(0.0, 640.0), random.uniform(0.0, 480.0));
    o.point_in_world = (board ? of_board : truth).inverse() * kCamera.back_project(o.pixel, o.depth);
    o.pixel += Eigen::Vector2d(random.gaussian(0.3), random.gaussian(0.3));
    observations.push_back(o);
  }
  const Pose captured = refine_pose(kCamera, observations, Pose::Identity(), {}).camera_from_world;
  EXPECT_GT(captured.translation().norm(), 0.03) << "least squares follows the board";
  const Consensus consensus = consensus_pose(kCamera, observations, {captured}, 200, 1);
  EXPECT_LT(consensus.camera_from_world.translation().norm(), 0.02);
}

}  // namespace
}  // namespace stillpoint
