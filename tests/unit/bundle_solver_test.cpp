// Local bundle adjustment's solver: its steps against the whole system's, its minimum against Ceres', which
// takes derivatives by itself.
#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "core/geometry/schur_equations.hpp"
#include "core/odometry/bundle_adjustment.hpp"
#include "core/odometry/pose_solver.hpp"

namespace stillpoint {
namespace {

constexpr double kNear = 1e-9;

/// Four cameras before sixty points; the first two are fixed. What is seen is off by up to `noise` px.
BundleProblem disturbed_bundle(const Camera& camera, double noise) {
  cv::RNG random(11);
  BundleProblem problem;
  std::vector<Pose> truth;
  for (int i = 0; i < 4; ++i) {
    Vector6d xi;
    xi << 0.08 * i, 0.02 * i, -0.03 * i, 0.01 * i, -0.02 * i, 0.015 * i;
    truth.push_back(se3_exp(xi));
    Vector6d off;
    for (int k = 0; k < 6; ++k) off[k] = random.uniform(-0.01, 0.01);
    problem.views.push_back({i, i < 2 ? truth.back() : Pose(se3_exp(off) * truth.back()), i < 2});
  }
  for (int p = 0; p < 60; ++p) {
    const Eigen::Vector3d point(random.uniform(-1.0, 1.0), random.uniform(-0.7, 0.7),
                                random.uniform(1.5, 3.5));
    problem.points.push_back({p, point * random.uniform(0.98, 1.02)});
    for (int i = 0; i < 4; ++i) {
      if ((p + i) % 5 == 0) continue;  // nobody sees everything
      const Eigen::Vector3d seen = truth[static_cast<std::size_t>(i)] * point;
      BundleProblem::Edge edge{i, p};
      edge.pixel = camera.project(seen) +
                   noise * Eigen::Vector2d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
      edge.depth = p % 3 == 0 ? 0.0 : seen.z() * random.uniform(0.999, 1.001);
      edge.sigma_px = 1.0 + 0.2 * (p % 4);
      edge.static_weight = p % 2 == 0 ? 1.0 : 0.5;
      problem.edges.push_back(edge);
    }
  }
  return problem;
}

/// The same problem in Ceres' own terms: angle-axis and translation, derivatives by dual numbers.
class ReferenceCost {
 public:
  ReferenceCost(const Camera& camera, const BundleProblem::Edge& edge, bool depth)
      : camera_(camera), edge_(edge), depth_(depth) {}

  template <typename T>
  bool operator()(const T* pose, const T* point, T* residual) const {
    T p[3];
    ceres::AngleAxisRotatePoint(pose, point, p);
    for (int k = 0; k < 3; ++k) p[k] += pose[3 + k];
    const double weight = std::sqrt(edge_.static_weight) / edge_.sigma_px;
    if (depth_) {
      const double bf = weight * camera_.baseline_or(kDepthBaseline) * camera_.fx;
      residual[0] = bf * (1.0 / edge_.depth - 1.0 / p[2]);
      residual[1] = T(0.0);
    } else {
      residual[0] = weight * (camera_.fx * p[0] / p[2] + camera_.cx - edge_.pixel.x());
      residual[1] = weight * (camera_.fy * p[1] / p[2] + camera_.cy - edge_.pixel.y());
    }
    return true;
  }

 private:
  const Camera& camera_;
  const BundleProblem::Edge& edge_;
  bool depth_;
};

BundleProblem solved_by_ceres(BundleProblem problem, const Camera& camera) {
  std::vector<std::array<double, 6>> poses(problem.views.size());
  ceres::Problem reference;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Pose& pose = problem.views[i].camera_from_world;
    const Eigen::Vector3d turn = so3_log(pose.linear());
    std::copy_n(turn.data(), 3, poses[i].data());
    std::copy_n(pose.translation().data(), 3, poses[i].data() + 3);
    reference.AddParameterBlock(poses[i].data(), 6);
    if (problem.views[i].fixed) reference.SetParameterBlockConstant(poses[i].data());
  }
  for (const auto& edge : problem.edges)
    for (const bool depth : {false, true}) {
      if (depth && edge.depth <= 0) continue;
      reference.AddResidualBlock(
          new ceres::AutoDiffCostFunction<ReferenceCost, 2, 6, 3>(new ReferenceCost(camera, edge, depth)),
          nullptr, poses[static_cast<std::size_t>(edge.view)].data(),
          problem.points[static_cast<std::size_t>(edge.point)].position.data());
    }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.function_tolerance = 1e-15;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-14;
  options.max_num_iterations = 200;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &reference, &summary);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.BriefReport();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    problem.views[i].camera_from_world.linear() = so3_exp(Eigen::Map<const Eigen::Vector3d>(poses[i].data()));
    problem.views[i].camera_from_world.translation() = Eigen::Map<const Eigen::Vector3d>(poses[i].data() + 3);
  }
  return problem;
}

TEST(BundleSolver, EndsWhereCeresDoes) {
  const Camera camera = camera_by_name("generated");
  BundleProblem problem = disturbed_bundle(camera, 0.5);
  BundleConfig config;
  config.iterations = 100;
  // Each solution begins where the last one ended, so that the bound on the cost's gain stops none too soon.
  BundleSolution ours = solve_bundle(problem, camera, config, 1.0);
  for (int again = 0; again < 3; ++again) ours = solve_bundle(ours.problem, camera, config, 1.0);
  ASSERT_TRUE(ours.usable);
  ASSERT_THAT(ours.outlier, ::testing::Each(0)) << "Ceres is given them all";
  const BundleProblem theirs = solved_by_ceres(problem, camera);
  for (std::size_t i = 0; i < problem.views.size(); ++i) {
    EXPECT_LT((ours.problem.views[i].camera_from_world.matrix() - theirs.views[i].camera_from_world.matrix())
                  .norm(),
              1e-5)
        << i;
    EXPECT_EQ(
        (theirs.views[i].camera_from_world.matrix() - problem.views[i].camera_from_world.matrix()).norm() >
            1e-3,
        !problem.views[i].fixed);
  }
  for (std::size_t i = 0; i < problem.points.size(); ++i)
    EXPECT_LT((ours.problem.points[i].position - theirs.points[i].position).norm(), 1e-4) << i;
}

TEST(BundleSolver, GivesUpWhereAPointLiesBehindItsCamera) {
  const Camera camera = camera_by_name("generated");
  BundleProblem problem = disturbed_bundle(camera, 0.1);
  problem.points[5].position.z() = -1.0;
  EXPECT_FALSE(solve_bundle(problem, camera, {}, 1.0).usable);
}

/// Random equations: `poses` of which the first is fixed, each point seen by some.
struct RandomSights {
  struct Sight {
    int pose = 0, point = 0;
    Eigen::Matrix3d rotation;
    SightEquations seen;
  };
  static constexpr int kPoses = 3, kPoints = 7;  // free poses

  std::vector<Sight> all;
  RandomSights() {
    cv::RNG random(3);
    const auto vector = [&] {
      return Eigen::Vector3d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(0.5, 2.0));
    };
    for (int point = 0; point < kPoints; ++point)
      for (int pose = SchurEquations::kFixed; pose < kPoses; ++pose) {
        if (point == 4) continue;  // nobody sees this one
        if ((point + pose) % 4 == 2) continue;
        Eigen::Matrix3d a;
        a << vector(), vector(), vector();
        all.push_back({pose, point, so3_exp(vector()), {a.transpose() * a, vector(), vector()}});
      }
  }

  /// The whole system, points behind poses, by ∂p/∂ξ = [I, -hat(p)] and ∂p/∂X = R.
  void whole(Eigen::MatrixXd& h, Eigen::VectorXd& g) const {
    constexpr int kSize = 6 * kPoses + 3 * kPoints;
    h = Eigen::MatrixXd::Zero(kSize, kSize);
    g = Eigen::VectorXd::Zero(kSize);
    for (const Sight& s : all) {
      Eigen::MatrixXd j = Eigen::MatrixXd::Zero(3, kSize);
      if (s.pose != SchurEquations::kFixed)
        j.middleCols(6 * s.pose, 6) << Eigen::Matrix3d::Identity(), -hat(s.seen.p);
      j.middleCols(6 * kPoses + 3 * s.point, 3) = s.rotation;
      h += j.transpose() * s.seen.h * j;
      g += j.transpose() * s.seen.g;
    }
  }
};

/// A view of it: columns are rows.
cv::Mat as_symmetric(Eigen::MatrixXd& h) {
  return {static_cast<int>(h.cols()), static_cast<int>(h.rows()), CV_64F, h.data()};
}

TEST(SchurEquations, StepAsTheWholeSystemDoes) {
  const RandomSights sights;
  SchurEquations equations;
  for (int twice = 0; twice < 2; ++twice) {  // … and once more after starting anew
    equations.reset(RandomSights::kPoses, RandomSights::kPoints);
    for (const auto& s : sights.all) equations.add(s.pose, s.point, s.rotation, s.seen);
  }
  Eigen::MatrixXd h;
  Eigen::VectorXd g;
  sights.whole(h, g);
  for (const double damping : {0.0, 0.1, 10.0}) {
    SchurEquations::Step step;
    ASSERT_TRUE(equations.solve(damping, step));
    Eigen::MatrixXd damped = h;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-9;
    Eigen::VectorXd expected(g.size());
    cv::Mat solution(static_cast<int>(g.size()), 1, CV_64F, expected.data());
    ASSERT_TRUE(cv::solve(as_symmetric(damped), -cv::Mat(static_cast<int>(g.size()), 1, CV_64F, g.data()),
                          solution, cv::DECOMP_LU));
    for (int i = 0; i < RandomSights::kPoses; ++i)
      EXPECT_LT((step.poses[static_cast<std::size_t>(i)] - expected.segment<6>(6 * i)).norm(), kNear)
          << damping;
    for (int i = 0; i < RandomSights::kPoints; ++i)
      EXPECT_LT(
          (step.points[static_cast<std::size_t>(i)] - expected.segment<3>(6 * RandomSights::kPoses + 3 * i))
              .norm(),
          kNear)
          << damping;
    EXPECT_EQ(step.points[4].norm(), 0.0) << "nothing was said of it";
    EXPECT_NEAR(step.cost_change, expected.dot(h * expected) + 2.0 * g.dot(expected), 1e-6) << damping;
    EXPECT_LT(step.cost_change, 0.0);
  }
}

TEST(SchurEquations, WithoutFreePosesMovePointsAlone) {
  SchurEquations equations;
  equations.reset(0, 1);
  equations.add(
      SchurEquations::kFixed, 0, Eigen::Matrix3d::Identity(),
      {2.0 * Eigen::Matrix3d::Identity(), Eigen::Vector3d(2.0, -4.0, 6.0), Eigen::Vector3d::UnitZ()});
  SchurEquations::Step step;
  ASSERT_TRUE(equations.solve(0.0, step));
  EXPECT_LT((step.points[0] - Eigen::Vector3d(-1.0, 2.0, -3.0)).norm(), 1e-8);
  EXPECT_THAT(step.poses, ::testing::IsEmpty());
}

}  // namespace
}  // namespace stillpoint
