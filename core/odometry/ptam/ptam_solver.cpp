#include "core/odometry/ptam/ptam_solver.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/normal_equations.hpp"

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

/// Normal equations of a bundle, points eliminated as they are summed.
class BundleStep {
 public:
  BundleStep(const PtamBundle& bundle, const Camera& camera, const PtamConfig& config,
             const std::vector<int>& place, const std::vector<std::vector<int>>& of_point,
             double bound_squared)
      : bundle_(bundle),
        camera_(camera),
        config_(config),
        place_(place),
        of_point_(of_point),
        bound_(bound_squared) {}

  /// Steps of views (6 each, of the free ones) and points (3 each). False where it is undecided.
  bool solve(double damping, Eigen::VectorXd& of_views, std::vector<Eigen::Vector3d>& of_points) {
    const auto free = static_cast<Eigen::Index>(
        std::count_if(place_.begin(), place_.end(), [](int at) { return at >= 0; }));
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(6 * free, 6 * free);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(6 * free);
    struct Part {
      Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
      Eigen::Vector3d b = Eigen::Vector3d::Zero();
      std::vector<std::pair<int, Eigen::Matrix<double, 6, 3>>> by_view;
    };
    std::vector<Part> parts(bundle_.points.size());
    for (std::size_t i = 0; i < bundle_.points.size(); ++i) {
      Part& part = parts[i];
      Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
      for (const int index : of_point_[i]) add(index, h, b, own, part.b, part.by_view);
      own.diagonal() *= 1.0 + damping;
      own.diagonal().array() += 1e-9;
      part.inverse = own.inverse();
      for (const auto& [view, across] : part.by_view) {
        const Eigen::Matrix<double, 6, 3> gain = across * part.inverse;
        b.segment<6>(6 * view).noalias() -= gain * part.b;
        for (const auto& [other, theirs] : part.by_view)
          h.block<6, 6>(6 * view, 6 * other).noalias() -= gain * theirs.transpose();
      }
    }
    of_views = Eigen::VectorXd::Zero(6 * free);
    if (free > 0) {
      for (Eigen::Index i = 0; i < h.rows(); ++i) h(i, i) += damping * std::abs(h(i, i)) + 1e-9;
      of_views = -solve_ldlt(h, b);
      if (!of_views.allFinite()) return false;
    }
    of_points.assign(parts.size(), Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      Eigen::Vector3d right = parts[i].b;
      for (const auto& [view, across] : parts[i].by_view)
        right += across.transpose() * of_views.segment<6>(6 * view);
      of_points[i] = -(parts[i].inverse * right);
    }
    return true;
  }

 private:
  void add(int index, Eigen::MatrixXd& h, Eigen::VectorXd& b, Eigen::Matrix3d& own, Eigen::Vector3d& own_b,
           std::vector<std::pair<int, Eigen::Matrix<double, 6, 3>>>& by_view) const {
    const PtamBundle::Measurement& one = bundle_.measurements[static_cast<std::size_t>(index)];
    const Residual residual = residual_of(bundle_, one, camera_, config_.bundle_depth_weight);
    if (!residual.seen) return;
    const double scale = std::ldexp(1.0, -one.level);
    Eigen::Matrix3d by_point = Eigen::Matrix3d::Zero();
    by_point.topRows<2>() = scale * pixel_by_point(camera_, residual.p);
    if (one.depth > 0.0)
      by_point(2, 2) = scale * config_.bundle_depth_weight * camera_.baseline_or(kDepthBaseline) *
                       camera_.fx / (residual.p.z() * residual.p.z());
    const double pixel = one.static_weight * tukey_weight(residual.squared(), bound_),
                 depth = one.static_weight * tukey_weight(residual.r[2] * residual.r[2], bound_);
    const Eigen::Vector3d w(pixel, pixel, depth);
    const Eigen::Matrix3d rotation =
        bundle_.views[static_cast<std::size_t>(one.view)].camera_from_world.linear();
    const Eigen::Matrix3d by_world = by_point * rotation;
    own.noalias() += by_world.transpose() * w.asDiagonal() * by_world;
    own_b.noalias() += by_world.transpose() * w.asDiagonal() * residual.r;
    const int at = place_[static_cast<std::size_t>(one.view)];
    if (at < 0) return;
    Eigen::Matrix<double, 3, 6> by_pose;
    by_pose << by_point, -by_point * hat(residual.p);
    h.block<6, 6>(6 * at, 6 * at).noalias() += by_pose.transpose() * w.asDiagonal() * by_pose;
    b.segment<6>(6 * at).noalias() += by_pose.transpose() * w.asDiagonal() * residual.r;
    by_view.emplace_back(at, by_pose.transpose() * w.asDiagonal() * by_world);
  }

  const PtamBundle& bundle_;
  const Camera& camera_;
  const PtamConfig& config_;
  const std::vector<int>& place_;
  const std::vector<std::vector<int>>& of_point_;
  double bound_;
};

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
  constexpr double kWorse = 4.0, kBetter = 0.3, kStill = 1e-6;
  std::vector<int> place;  // of each view among the free ones; -1: fixed
  int free = 0;
  for (const auto& view : bundle.views) place.push_back(view.fixed ? -1 : free++);
  std::vector<std::vector<int>> of_point(bundle.points.size());
  for (std::size_t i = 0; i < bundle.measurements.size(); ++i)
    of_point[static_cast<std::size_t>(bundle.measurements[i].point)].push_back(static_cast<int>(i));
  bundle.rms_before_px = rms_of(bundle, camera, false);
  double damping = 1e-4;
  for (int tries = 0; tries < config.bundle_iterations; ++tries) {
    const double bound = bound_of(bundle, camera, config);
    BundleStep step(bundle, camera, config, place, of_point, bound);
    Eigen::VectorXd of_views;
    std::vector<Eigen::Vector3d> of_points;
    if (!step.solve(damping, of_views, of_points)) break;
    PtamBundle moved = bundle;
    double squared = of_views.squaredNorm();
    for (std::size_t i = 0; i < moved.views.size(); ++i)
      if (place[i] >= 0)
        moved.views[i].camera_from_world =
            normalised(se3_exp(of_views.segment<6>(6 * place[i])) * moved.views[i].camera_from_world);
    for (std::size_t i = 0; i < moved.points.size(); ++i) {
      moved.points[i].world += of_points[i];
      squared += of_points[i].squaredNorm();
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
