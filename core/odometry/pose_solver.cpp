#include "core/odometry/pose_solver.hpp"

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

namespace stillpoint {
namespace {

/// One observation's residual (px; pixel twice, then depth as disparity) and its Jacobian by a left
/// perturbation.
struct Linearised {
  Eigen::Vector3d residual;
  Eigen::Matrix<double, 3, 6> jacobian;
  bool in_front = false;
};

class PoseProblem {
 public:
  PoseProblem(const Camera& camera, const std::vector<PoseObservation>& observations, double depth_weight)
      : camera_(camera), observations_(observations), depth_weight_(depth_weight) {}

  [[nodiscard]] bool uses_depth(const PoseObservation& o) const { return depth_weight_ > 0 && o.depth > 0; }

  /// Weighted by 1/σ, so that squared norms are χ².
  [[nodiscard]] Linearised linearise(const PoseObservation& o, const Pose& camera_from_world,
                                     bool with_jacobian) const {
    Linearised result;
    const Eigen::Vector3d p = camera_from_world * o.point_in_world;
    result.in_front = p.z() > 0.05;
    if (!result.in_front) return result;
    const double weight = 1.0 / o.sigma_px, iz = 1.0 / p.z();
    const bool depth = uses_depth(o);
    const double bf = kDepthBaseline * camera_.fx, depth_weight = weight * depth_weight_;
    const Eigen::Vector2d projected = camera_.project(p);
    result.residual.head<2>() = weight * (projected - o.pixel);
    result.residual.z() = depth ? depth_weight * bf * (1.0 / o.depth - iz) : 0.0;
    if (!with_jacobian) return result;

    Eigen::Matrix3d by_point;  // d residual / d p
    by_point.row(0) << weight * camera_.fx * iz, 0, -weight * camera_.fx * p.x() * iz * iz;
    by_point.row(1) << 0, weight * camera_.fy * iz, -weight * camera_.fy * p.y() * iz * iz;
    by_point.row(2) << 0, 0, depth ? depth_weight * bf * iz * iz : 0.0;
    result.jacobian.leftCols<3>() = by_point;
    result.jacobian.rightCols<3>() = -by_point * hat(p);
    return result;
  }

  [[nodiscard]] double chi2(const PoseObservation& o, const Pose& pose) const {
    const Linearised l = linearise(o, pose, false);
    return l.in_front ? l.residual.squaredNorm() : std::numeric_limits<double>::infinity();
  }

  [[nodiscard]] double bound(const PoseObservation& o) const {
    return uses_depth(o) ? kChi2PixelDepth : kChi2Pixel;
  }

 private:
  const Camera& camera_;
  const std::vector<PoseObservation>& observations_;
  double depth_weight_;
};

/// Huber's cost of a χ² value, with the bound squared as given.
double huber(double chi2, double bound) {
  return chi2 <= bound ? chi2 : 2.0 * std::sqrt(chi2 * bound) - bound;
}

struct NormalEquations {
  Matrix6d h = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double cost = 0.0;
};

NormalEquations normal_equations(const PoseProblem& problem, const std::vector<PoseObservation>& observations,
                                 const std::vector<std::uint8_t>& inlier, const Pose& pose, bool robust) {
  NormalEquations n;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!inlier[i]) continue;
    const Linearised l = problem.linearise(observations[i], pose, true);
    if (!l.in_front) continue;
    const double chi2 = l.residual.squaredNorm(), bound = problem.bound(observations[i]);
    const double weight = robust && chi2 > bound ? std::sqrt(bound / chi2) : 1.0;
    n.h.noalias() += weight * l.jacobian.transpose() * l.jacobian;
    n.g.noalias() += weight * l.jacobian.transpose() * l.residual;
    n.cost += robust ? huber(chi2, bound) : chi2;
  }
  return n;
}

/// Levenberg-Marquardt over the inliers; returns the number of steps taken.
int levenberg_marquardt(const PoseProblem& problem, const std::vector<PoseObservation>& observations,
                        const std::vector<std::uint8_t>& inlier, bool robust, int max_steps, Pose& pose) {
  constexpr double kConverged = 1e-7;  // m and rad: far below what pixels can tell
  double lambda = 1e-4;
  NormalEquations current = normal_equations(problem, observations, inlier, pose, robust);
  int steps = 0;
  while (steps < max_steps) {
    ++steps;
    Matrix6d damped = current.h;
    damped.diagonal() += lambda * current.h.diagonal() + Vector6d::Constant(1e-9);
    const Vector6d step = -damped.ldlt().solve(current.g);
    if (!step.allFinite()) break;
    const Pose candidate = se3_exp(step) * pose;
    const NormalEquations next = normal_equations(problem, observations, inlier, candidate, robust);
    if (next.cost < current.cost) {
      pose = candidate;
      current = next;
      lambda = std::max(lambda * 0.1, 1e-9);
      if (step.norm() < kConverged) break;
    } else {
      lambda *= 10.0;
      if (lambda > 1e6 || step.norm() < kConverged) break;
    }
  }
  return steps;
}

}  // namespace

PoseRefinement refine_pose(const Camera& camera, const std::vector<PoseObservation>& observations,
                           const Pose& initial_camera_from_world, const TrackingConfig& config) {
  PoseRefinement result;
  result.camera_from_world = initial_camera_from_world;
  result.inlier.assign(observations.size(), 1);
  result.residual_px.assign(observations.size(), 0.0F);
  if (observations.size() < 3) {
    result.inlier.assign(observations.size(), 0);
    return result;
  }
  const PoseProblem problem(camera, observations, config.depth_weight);
  for (int round = 0; round < config.refine_rounds; ++round) {
    // Robust while outliers are still among the inliers; plain least squares once they are told apart.
    const bool robust = round < 2;
    Pose pose = result.camera_from_world;
    result.iterations +=
        levenberg_marquardt(problem, observations, result.inlier, robust, config.refine_iterations, pose);
    result.camera_from_world = pose;
    result.inliers = 0;
    for (std::size_t i = 0; i < observations.size(); ++i) {
      result.inlier[i] = problem.chi2(observations[i], pose) <= problem.bound(observations[i]);
      result.inliers += result.inlier[i];
    }
    if (result.inliers < 6) break;
  }

  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const auto& o = observations[i];
    const Eigen::Vector3d p = result.camera_from_world * o.point_in_world;
    const double squared = (camera.project(p) - o.pixel).squaredNorm();
    result.residual_px[i] = static_cast<float>(std::sqrt(squared));
    if (!result.inlier[i]) continue;
    after += squared;
    before += (camera.project(initial_camera_from_world * o.point_in_world) - o.pixel).squaredNorm();
  }
  if (result.inliers > 0) {
    result.rms_px = std::sqrt(after / result.inliers);
    result.rms_before_px = std::sqrt(before / result.inliers);
  }
  result.information =
      normal_equations(problem, observations, result.inlier, result.camera_from_world, false).h;
  result.camera_from_world = normalised(result.camera_from_world);
  return result;
}

std::optional<InitialPose> initial_pose(const Camera& camera,
                                        const std::vector<PoseObservation>& observations,
                                        const TrackingConfig& config) {
  if (static_cast<int>(observations.size()) < config.min_initial_matches) return std::nullopt;
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const auto& o : observations) {
    points.emplace_back(o.point_in_world.x(), o.point_in_world.y(), o.point_in_world.z());
    pixels.emplace_back(o.pixel.x(), o.pixel.y());
  }
  cv::Mat rotation_vector, translation, rotation;
  std::vector<int> inliers;
  const bool found = cv::solvePnPRansac(
      points, pixels, camera.matrix(), cv::noArray(), rotation_vector, translation, false,
      config.pnp_iterations, static_cast<float>(config.pnp_threshold_px), 0.99, inliers, cv::SOLVEPNP_EPNP);
  if (!found || static_cast<int>(inliers.size()) < config.min_initial_matches) return std::nullopt;
  cv::Rodrigues(rotation_vector, rotation);
  InitialPose result;
  Eigen::Matrix3d r;
  Eigen::Vector3d t;
  cv::cv2eigen(rotation, r);
  cv::cv2eigen(translation, t);
  if (!r.allFinite() || !t.allFinite()) return std::nullopt;
  result.camera_from_world.linear() = r;
  result.camera_from_world.translation() = t;
  result.inliers = std::move(inliers);
  return result;
}

}  // namespace stillpoint
