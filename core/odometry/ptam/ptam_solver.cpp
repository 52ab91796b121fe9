#include "core/odometry/ptam/ptam_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/geometry/normal_equations.hpp"
#include "core/geometry/schur_equations.hpp"

namespace stillpoint {
namespace {

constexpr double kDepthBaseline = 0.08;  // m: inverse depth times this and the focal length, in px

Eigen::Matrix<double, 2, 3> pixel_by_point(const Camera& camera, const Eigen::Vector3d& p) {
  const double iz = 1.0 / p.z();
  Eigen::Matrix<double, 2, 3> j;
  j << camera.fx * iz, 0, -camera.fx * p.x() * iz * iz, 0, camera.fy * iz, -camera.fy * p.y() * iz * iz;
  return j;
}

/// Residual of a measurement in px of its level: two of the pixel, one of the depth.
struct Residual {
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  // in the camera
  bool seen = false;
  [[nodiscard]] double squared() const { return r.head<2>().squaredNorm(); }
};

Residual residual_of(const PtamBundle& bundle, const PtamBundle::Measurement& one, const Camera& camera,
                     double depth_weight) {
  Residual residual;
  residual.p = bundle.views[static_cast<std::size_t>(one.view)].camera_from_world *
               bundle.points[static_cast<std::size_t>(one.point)].world;
  if (residual.p.z() < kNearestProjected) return residual;
  const double scale = std::ldexp(1.0, -one.level);
  residual.r.head<2>() = scale * (camera.project(residual.p) - one.pixel);
  if (one.depth > 0.0)
    residual.r[2] = scale * depth_weight * camera.baseline_or(kDepthBaseline) * camera.fx *
                    (1.0 / one.depth - 1.0 / residual.p.z());
  residual.seen = true;
  return residual;
}

/// The Tukey objective: bound²/6 (1 - (1 - e²/bound²)³), as twice a weighted square for small errors.
double tukey_cost(double squared, double bound_squared) {
  if (squared >= bound_squared) return bound_squared / 3.0;
  const double rest = 1.0 - squared / bound_squared;
  return bound_squared / 3.0 * (1.0 - rest * rest * rest);
}

/// The equations of a bundle with Tukey's weights.
/// @param place of each view among the free ones, or SchurEquations::kFixed @param order measurements, point
/// by point
void linearise(const PtamBundle& bundle, const Camera& camera, const PtamConfig& config,
               const std::vector<int>& place, const std::vector<int>& order, double bound_squared,
               SchurEquations& equations) {
  const auto free =
      std::count_if(place.begin(), place.end(), [](int at) { return at != SchurEquations::kFixed; });
  equations.reset(static_cast<int>(free), static_cast<int>(bundle.points.size()));
  for (const int index : order) {
    const PtamBundle::Measurement& one = bundle.measurements[static_cast<std::size_t>(index)];
    const Residual residual = residual_of(bundle, one, camera, config.bundle_depth_weight);
    if (!residual.seen) continue;
    const double scale = std::ldexp(1.0, -one.level);
    Eigen::Matrix3d by_point = Eigen::Matrix3d::Zero();
    by_point.topRows<2>() = scale * pixel_by_point(camera, residual.p);
    if (one.depth > 0.0)
      by_point(2, 2) = scale * config.bundle_depth_weight * camera.baseline_or(kDepthBaseline) * camera.fx /
                       (residual.p.z() * residual.p.z());
    const double pixel = one.static_weight * tukey_weight(residual.squared(), bound_squared),
                 depth = one.static_weight * tukey_weight(residual.r[2] * residual.r[2], bound_squared);
    const Eigen::Matrix3d weighted = by_point.transpose() * Eigen::Vector3d(pixel, pixel, depth).asDiagonal();
    const auto view = static_cast<std::size_t>(one.view);
    equations.add(place[view], one.point, bundle.views[view].camera_from_world.linear(),
                  {weighted * by_point, weighted * residual.r, residual.p});
  }
}

double cost_of(const PtamBundle& bundle, const Camera& camera, const PtamConfig& config,
               double bound_squared) {
  double cost = 0.0;
  for (const auto& one : bundle.measurements) {
    const Residual residual = residual_of(bundle, one, camera, config.bundle_depth_weight);
    if (!residual.seen) {
      cost += 2.0 * bound_squared / 3.0;
      continue;
    }
    cost += one.static_weight * (tukey_cost(residual.squared(), bound_squared) +
                                 tukey_cost(residual.r[2] * residual.r[2], bound_squared));
  }
  return cost;
}

double bound_of(const PtamBundle& bundle, const Camera& camera, const PtamConfig& config) {
  std::vector<double> squared;
  for (const auto& one : bundle.measurements)
    if (const Residual residual = residual_of(bundle, one, camera, 0.0); residual.seen)
      squared.push_back(residual.squared());
  const double least = config.bundle_least_sigma_px * config.bundle_least_sigma_px;
  return squared.size() > 3 ? std::max(least, tukey_bound_squared(squared)) : least;
}

double rms_of(const PtamBundle& bundle, const Camera& camera, bool inliers_alone) {
  double sum = 0.0;
  int count = 0;
  for (const auto& one : bundle.measurements) {
    if (inliers_alone && one.outlier) continue;
    const Residual residual = residual_of(bundle, one, camera, 0.0);
    if (residual.seen) sum += residual.squared(), ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

}  // namespace

double tukey_bound_squared(std::vector<double>& squared) {
  const auto middle = squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2);
  std::nth_element(squared.begin(), middle, squared.end());
  const auto n = static_cast<double>(squared.size());
  const double sigma = 1.4826 * (1.0 + 5.0 / (2.0 * n - 6.0)) * std::sqrt(*middle);
  return 4.6851 * 4.6851 * sigma * sigma;
}

double tukey_weight(double squared, double bound_squared) {
  if (squared >= bound_squared) return 0.0;
  const double rest = 1.0 - squared / bound_squared;
  return rest * rest;
}

PtamPose solve_ptam_pose(std::vector<PtamSight>& sights, const Pose& start, const Camera& camera,
                         double late_bound_squared, const PtamConfig& config) {
  constexpr int kFree = 6;  // steps whose bound is the errors' own
  PtamPose result;
  result.camera_from_world = start;
  double bound = late_bound_squared;
  const auto errors = [&] {
    for (PtamSight& sight : sights) {
      const Eigen::Vector3d p = result.camera_from_world * sight.world;
      sight.squared_px = p.z() < kNearestProjected ? std::numeric_limits<double>::infinity()
                                                   : (camera.project(p) - sight.pixel).squaredNorm() *
                                                         std::ldexp(1.0, -2 * sight.level);
    }
  };
  for (int step = 0; step < config.iterations; ++step) {
    errors();
    bound = late_bound_squared;
    if (step < kFree && sights.size() > 3) {
      std::vector<double> squared;
      for (const PtamSight& sight : sights) squared.push_back(sight.squared_px);
      bound = std::max(1e-6, tukey_bound_squared(squared));
    }
    Matrix6d h = config.prior * Matrix6d::Identity();
    Vector6d b = Vector6d::Zero();
    for (const PtamSight& sight : sights) {
      const double w = sight.static_weight * tukey_weight(sight.squared_px, bound);
      if (w <= 0.0) continue;
      const Eigen::Vector3d p = result.camera_from_world * sight.world;
      const double scale = std::ldexp(1.0, -sight.level);
      Eigen::Matrix<double, 2, 6> j;
      const Eigen::Matrix<double, 2, 3> by_point = scale * pixel_by_point(camera, p);
      j << by_point, -by_point * hat(p);
      h.noalias() += w * j.transpose() * j;
      b.noalias() += w * j.transpose() * (scale * (camera.project(p) - sight.pixel));
    }
    const Vector6d change = -solve_ldlt(h, b);
    if (!change.allFinite()) break;
    result.camera_from_world = normalised(se3_exp(change) * result.camera_from_world);
    ++result.iterations;
  }
  errors();
  for (PtamSight& sight : sights) sight.weight = tukey_weight(sight.squared_px, bound);
  result.bound_px = std::sqrt(bound);
  return result;
}

void solve_ptam_bundle(PtamBundle& bundle, const Camera& camera, const PtamConfig& config) {
  // The damping goes by factors. A step of fewer m² and rad² over all that moves ends it.
  constexpr double kWorse = 4.0, kBetter = 0.3, kStill = 1e-6;
  std::vector<int> place;  // of each view among the free ones
  int free = 0;
  for (const auto& view : bundle.views) place.push_back(view.fixed ? SchurEquations::kFixed : free++);
  std::vector<int> order(bundle.measurements.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return bundle.measurements[static_cast<std::size_t>(a)].point <
           bundle.measurements[static_cast<std::size_t>(b)].point;
  });
  SchurEquations equations;
  SchurEquations::Step step;
  bundle.rms_before_px = rms_of(bundle, camera, false);
  double damping = 1e-4;
  for (int tries = 0; tries < config.bundle_iterations; ++tries) {
    const double bound = bound_of(bundle, camera, config);
    linearise(bundle, camera, config, place, order, bound, equations);
    if (!equations.solve(damping, step)) break;
    PtamBundle moved = bundle;
    double squared = 0.0;
    for (std::size_t i = 0; i < moved.views.size(); ++i) {
      if (place[i] == SchurEquations::kFixed) continue;
      const Vector6d& change = step.poses[static_cast<std::size_t>(place[i])];
      moved.views[i].camera_from_world = normalised(se3_exp(change) * moved.views[i].camera_from_world);
      squared += change.squaredNorm();
    }
    for (std::size_t i = 0; i < moved.points.size(); ++i) {
      moved.points[i].world += step.points[i];
      squared += step.points[i].squaredNorm();
    }
    if (cost_of(moved, camera, config, bound) > cost_of(bundle, camera, config, bound)) {
      damping *= kWorse;
      continue;
    }
    bundle.views = std::move(moved.views);
    bundle.points = std::move(moved.points);
    damping *= kBetter;
    ++bundle.iterations;
    if (squared < kStill) break;
  }
  const double bound = bound_of(bundle, camera, config);
  for (auto& one : bundle.measurements) {
    const Residual residual = residual_of(bundle, one, camera, 0.0);
    one.outlier = !residual.seen || residual.squared() >= bound;
  }
  bundle.rms_after_px = rms_of(bundle, camera, true);
}

}  // namespace stillpoint
