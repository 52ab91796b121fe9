#include "core/odometry/pose_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geometry/normal_equations.hpp"
#include "core/odometry/adaptive_kernel.hpp"

namespace stillpoint {
namespace {

const Camera kSolverCamera = camera_by_name("freiburg3");

Pose some_pose() {
  Vector6d xi;
  xi << 0.1, -0.05, 0.2, 0.03, -0.08, 0.02;
  return se3_exp(xi);
}

/// Observations of points 1 to 4 m ahead of the camera at `camera_from_world`, with pixel noise.
std::vector<PoseObservation> observe(const Pose& camera_from_world, int count, double noise_px, bool depth,
                                     unsigned seed = 7) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(20, 620), y(20, 460), z(1, 4);
  std::normal_distribution<double> noise(0, noise_px);
  std::vector<PoseObservation> observations;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d pixel(x(random), y(random));
    const Eigen::Vector3d in_camera = kSolverCamera.back_project(pixel, z(random));
    PoseObservation o;
    o.point_in_world = camera_from_world.inverse() * in_camera;
    o.pixel = pixel + Eigen::Vector2d(noise(random), noise(random));
    o.depth = depth ? in_camera.z() : 0.0;
    observations.push_back(o);
  }
  return observations;
}

double pose_distance(const Pose& a, const Pose& b) { return (a.inverse() * b).translation().norm(); }

TEST(RefinePose, FindsThePoseOfExactObservations) {
  for (const bool depth : {false, true}) {
    const auto observations = observe(some_pose(), 60, 0.0, depth);
    const PoseRefinement refined = refine_pose(kSolverCamera, observations, Pose::Identity(), {});
    EXPECT_LT(pose_distance(refined.camera_from_world, some_pose()), 1e-6);
    EXPECT_LT(rotation_angle(refined.camera_from_world.linear().transpose() * some_pose().linear()), 1e-6);
    EXPECT_EQ(refined.inliers, 60);
    EXPECT_GT(refined.rms_before_px, 10.0);
    EXPECT_LT(refined.rms_px, 1e-4);
  }
}

TEST(RefinePose, TellsOutliersApart) {
  auto observations = observe(some_pose(), 100, 0.5, true);
  for (std::size_t i = 0; i < 30; ++i) observations[i].pixel.x() += 25.0;
  const PoseRefinement refined = refine_pose(kSolverCamera, observations, Pose::Identity(), {});
  EXPECT_LT(pose_distance(refined.camera_from_world, some_pose()), 0.01);
  for (std::size_t i = 0; i < 30; ++i) EXPECT_FALSE(refined.inlier[i]) << i;
  EXPECT_GE(refined.inliers, 65);
}

TEST(RefinePose, IsTheSameToTheLastBitWhateverTheLanes) {
  if (!has_wide_lanes()) GTEST_SKIP() << "this processor has no wide lanes";
  for (const bool adaptive : {false, true})
    for (const int count : {3, 4, 61, 64, 203}) {
      auto observations = observe(some_pose(), count, 0.7, true, static_cast<unsigned>(count));
      for (std::size_t i = 0; i < observations.size(); i += 5) {
        observations[i].pixel.y() += 9.0;
        observations[i].depth = 0.0;
        observations[i].static_weight = 0.3;
        observations[i].sigma_px = 1.44;
      }
      TrackingConfig config;
      config.adaptive_kernel = adaptive;
      const auto by = [&](bool wide) {
        return refine_pose(kSolverCamera, observations, Pose::Identity(), config, 0.0, wide);
      };
      const PoseRefinement plain = by(false), wide = by(true);
      EXPECT_EQ(plain.camera_from_world.matrix(), wide.camera_from_world.matrix()) << count;
      EXPECT_EQ(plain.information, wide.information) << count;
      EXPECT_EQ(plain.noise, wide.noise) << count;
      EXPECT_EQ(plain.inlier, wide.inlier) << count;
      EXPECT_EQ(plain.iterations, wide.iterations) << count;
    }
}

TEST(RefinePose, ItsCovarianceIsHowItsPosesScatter) {
  Eigen::Matrix3d positions = Eigen::Matrix3d::Zero(), rotations = Eigen::Matrix3d::Zero(), said = positions;
  constexpr int kTrials = 300;
  auto observations = observe(some_pose(), 80, 0.0, false);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.4);
  for (int trial = 0; trial < kTrials; ++trial) {
    auto noisy = observations;
    for (PoseObservation& o : noisy) o.pixel += Eigen::Vector2d(noise(random), noise(random));
    const PoseRefinement refined = refine_pose(kSolverCamera, noisy, some_pose(), {});
    const Vector6d off = se3_log(refined.camera_from_world * some_pose().inverse());
    positions += off.head<3>() * off.head<3>().transpose() / kTrials;
    rotations += off.tail<3>() * off.tail<3>().transpose() / kTrials;
    said += refined.covariance().topLeftCorner<3, 3>() / kTrials;
    ASSERT_EQ(refined.covariance(), refined.covariance().transpose());
  }
  EXPECT_NEAR(largest_deviation(said) / largest_deviation(positions), 1.0, 0.15);
  EXPECT_GT(largest_deviation(rotations), 0.0);
}

TEST(RefinePose, ItsCovarianceTellsADegenerateView) {
  // All on one far wall, seen through a narrow part of the image.
  const auto all = observe(some_pose(), 80, 0.3, false);
  std::vector<PoseObservation> few;
  for (const PoseObservation& o : all)
    if (std::abs(o.pixel.x() - 320) < 120 && std::abs(o.pixel.y() - 240) < 90) few.push_back(o);
  ASSERT_GE(few.size(), 8U);
  const auto sigma = [](const std::vector<PoseObservation>& seen) {
    return largest_deviation(
        refine_pose(kSolverCamera, seen, some_pose(), {}).covariance().topLeftCorner<3, 3>());
  };
  EXPECT_GT(sigma(few), 3 * sigma(all));
  EXPECT_TRUE(refine_pose(kSolverCamera, {}, some_pose(), {}).covariance().isZero(0.0))
      << "nothing tells nothing";
}

TEST(AdaptiveKernel, HasTheLossesItGeneralises) {
  for (const double square : {0.0, 0.3, 2.0, 40.0}) {
    EXPECT_NEAR(AdaptiveKernel(2).cost(square), 0.5 * square, 1e-12);
    EXPECT_NEAR(AdaptiveKernel(1).cost(square), std::sqrt(square + 1) - 1, 1e-12);
    EXPECT_NEAR(AdaptiveKernel(0).cost(square), std::log(0.5 * square + 1), 1e-12);
    EXPECT_NEAR(AdaptiveKernel(-2).cost(square), 2 * square / (square + 4), 1e-12);
    for (const double shape : {-3.0, -2.0, 0.0, 0.4, 1.0, 2.0}) {
      const AdaptiveKernel kernel(shape);
      constexpr double kStep = 1e-5;
      EXPECT_NEAR(kernel.weight(square + kStep),
                  (kernel.cost(square + 2 * kStep) - kernel.cost(square)) / kStep, 1e-4)
          << "shape " << shape;
    }
  }
}

TEST(AdaptiveKernel, TakesItsShapeFromTheResiduals) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::cauchy_distribution<double> heavy;
  std::vector<double> good, bad;
  for (int i = 0; i < 2000; ++i) {
    const double g = normal(random), b = heavy(random);
    good.push_back(g * g), bad.push_back(b * b);
  }
  EXPECT_GE(AdaptiveKernel::likeliest(good).shape(), 1.6);
  EXPECT_LE(AdaptiveKernel::likeliest(bad).shape(), 0.6);
  EXPECT_EQ(AdaptiveKernel::likeliest({}).shape(), 1.0);
}

TEST(AdaptiveKernel, APoseIsFoundThroughOutliers) {
  auto observations = observe(some_pose(), 100, 0.5, true);
  for (std::size_t i = 0; i < 35; ++i) observations[i].pixel.x() += 25.0;
  TrackingConfig config;
  config.adaptive_kernel = true;
  const PoseRefinement refined = refine_pose(kSolverCamera, observations, Pose::Identity(), config);
  EXPECT_LT(pose_distance(refined.camera_from_world, some_pose()), 0.01);
  EXPECT_GE(refined.inliers, 60);
}

/// Exact observations, of which the first 40 of 100 are seen 1.5 px beside their place: no outliers, but all
/// wrong the same way.
std::vector<PoseObservation> drifting(double static_weight) {
  auto observations = observe(some_pose(), 100, 0.0, true);
  for (std::size_t i = 0; i < 40; ++i) {
    observations[i].pixel.x() += 1.5;
    observations[i].static_weight = static_weight;
  }
  return observations;
}

TEST(RefinePose, WeightsWeighObservations) {
  const auto error = [](double static_weight) {
    return pose_distance(
        refine_pose(kSolverCamera, drifting(static_weight), some_pose(), {}).camera_from_world, some_pose());
  };
  EXPECT_LT(error(1e-6), 1e-5);
  EXPECT_LT(error(0.1), 0.5 * error(1.0));
  EXPECT_GT(error(1.0), 1e-3);
}

TEST(RefinePose, WeightsDoNotChangeWhatIsAnOutlier) {
  auto observations = drifting(1e-6);
  observations[3].pixel.x() += 20.0;
  const PoseRefinement refined = refine_pose(kSolverCamera, observations, some_pose(), {});
  EXPECT_EQ(refined.inliers, 99);
  EXPECT_FALSE(refined.inlier[3]);
}

TEST(RefinePose, ResidualsArePixelDistances) {
  auto observations = observe(Pose::Identity(), 40, 0.0, false);
  observations[5].pixel += Eigen::Vector2d(3.0, 4.0);  // 5 px off
  const PoseRefinement refined = refine_pose(kSolverCamera, observations, Pose::Identity(), {});
  EXPECT_FALSE(refined.inlier[5]);
  EXPECT_NEAR(refined.residual_px[5], 5.0, 0.05);
}

TEST(RefinePose, InformationIsTheInverseOfTheSpread) {
  // Poses estimated from many draws of noise scatter as the inverse of the information says (1 px noise,
  // sigma 1).
  const int draws = 200;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  Eigen::Vector3d predicted = Eigen::Vector3d::Zero();
  TrackingConfig config;
  config.depth_weight = 0.0;
  for (int d = 0; d < draws; ++d) {
    auto observations = observe(Pose::Identity(), 80, 0.0, false);
    std::mt19937 random(static_cast<unsigned>(d));
    std::normal_distribution<double> noise(0, 0.5);
    for (auto& o : observations) {
      o.pixel += Eigen::Vector2d(noise(random), noise(random));
      o.sigma_px = 0.5;
    }
    const PoseRefinement refined = refine_pose(kSolverCamera, observations, Pose::Identity(), config);
    const Eigen::Vector3d t = se3_log(refined.camera_from_world).head<3>();
    sum += t;
    squares += t.cwiseAbs2();
    const Matrix6d covariance = refined.information.inverse();
    predicted += covariance.diagonal().head<3>();
  }
  const Eigen::Vector3d variance = squares / draws - (sum / draws).cwiseAbs2();
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(variance[axis] / (predicted[axis] / draws), 1.0, 0.35) << axis;
}

TEST(RefinePose, AHeldStartIsNotDrawnAwayByWhatMoves) {
  // Nearly half of what is seen has gone on by 3 cm as one thing, and near: it draws least squares along.
  auto observations = observe(some_pose(), 200, 0.3, true);
  Pose moved = some_pose();
  moved.translation().x() += 0.03;
  for (std::size_t i = 0; i < 95; ++i) {
    const Eigen::Vector3d p = kSolverCamera.back_project(observations[i].pixel, 1.0);
    observations[i].point_in_world = moved.inverse() * p;
    observations[i].depth = 1.0;
  }
  Pose start = some_pose();
  start.translation().y() += 0.002;
  const auto error = [&](double gate) {
    return pose_distance(refine_pose(kSolverCamera, observations, start, {}, gate).camera_from_world,
                         some_pose());
  };
  EXPECT_GT(error(0.0), 0.01);
  EXPECT_LT(error(2.0), 0.003);
  EXPECT_EQ(error(1e-9), error(0.0)) << "where next to nothing agrees with the start, all take part";
}

TEST(RefinePose, TooFewObservationsLeaveThePoseAlone) {
  const PoseRefinement refined =
      refine_pose(kSolverCamera, observe(Pose::Identity(), 2, 0, true), some_pose(), {});
  EXPECT_EQ(refined.inliers, 0);
  EXPECT_LT(pose_distance(refined.camera_from_world, some_pose()), 1e-12);
}

TEST(InitialPose, EpnpInRansacSurvivesHalfOutliers) {
  auto observations = observe(some_pose(), 120, 0.5, false);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(0, 640), y(0, 480);
  for (std::size_t i = 0; i < 60; ++i) observations[i].pixel = {x(random), y(random)};
  const auto initial = initial_pose(kSolverCamera, observations, {});
  ASSERT_TRUE(initial);
  EXPECT_LT(pose_distance(initial->camera_from_world, some_pose()), 0.05);
  EXPECT_GE(initial->inliers.size(), 50u);
}

TEST(InitialPose, NoiseAloneGivesNone) {
  auto observations = observe(some_pose(), 60, 0.0, false);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(0, 640), y(0, 480);
  for (auto& o : observations) o.pixel = {x(random), y(random)};
  EXPECT_FALSE(initial_pose(kSolverCamera, observations, {}));
  EXPECT_FALSE(initial_pose(kSolverCamera, observe(some_pose(), 5, 0, false), {}));
}

}  // namespace
}  // namespace stillpoint
