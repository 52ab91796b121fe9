#include "core/odometry/bundle_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/geometry/levenberg_marquardt.hpp"
#include "core/geometry/schur_equations.hpp"
#include "core/odometry/matching.hpp"
#include "core/odometry/pose_solver.hpp"

namespace stillpoint {
namespace {

constexpr double kChi2Depth = 3.841;  // 95 % bound with one degree of freedom

/// The squared weighted residual of an edge, and its plain distance in the image.
struct EdgeError {
  double chi2 = 0.0, squared_px = 0.0;
};

EdgeError edge_error(const BundleProblem& problem, const BundleProblem::Edge& edge, const Camera& camera,
                     double depth_weight) {
  const Eigen::Vector3d p = problem.views[static_cast<std::size_t>(edge.view)].camera_from_world *
                            problem.points[static_cast<std::size_t>(edge.point)].position;
  if (p.z() <= 0) return {std::numeric_limits<double>::infinity(), 0.0};
  EdgeError error;
  error.squared_px = (camera.project(p) - edge.pixel).squaredNorm();
  const double depth_px = edge.depth > 0 ? depth_weight * camera.baseline_or(kDepthBaseline) * camera.fx *
                                               (1.0 / edge.depth - 1.0 / p.z())
                                         : 0.0;
  error.chi2 = (error.squared_px + depth_px * depth_px) / (edge.sigma_px * edge.sigma_px);
  return error;
}

double rms(const BundleProblem& problem, const std::vector<std::uint8_t>& outlier, const Camera& camera) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < problem.edges.size(); ++i) {
    if (outlier[i]) continue;
    sum += edge_error(problem, problem.edges[i], camera, 0.0).squared_px;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

/// Huber's loss of a squared residual: its cost in the unit of squares, and the weight of its squares.
struct Loss {
  double cost = 0.0, weight = 1.0;
};
Loss huber(double squared, double bound_squared, bool robust) {
  if (!robust || squared <= bound_squared) return {squared, 1.0};
  const double share = std::sqrt(bound_squared / squared);
  return {2.0 * share * squared - bound_squared, share};
}

/// Views and points on their way to the least cost of the edges that are no outliers.
class BundleDescent {
 public:
  BundleDescent(BundleProblem& problem, const std::vector<std::uint8_t>& outlier, const Camera& camera,
                double depth_weight)
      : problem_(problem), outlier_(outlier), camera_(camera), depth_weight_(depth_weight) {
    for (const auto& view : problem.views) place_.push_back(view.fixed ? SchurEquations::kFixed : free_++);
  }

  /// Under Huber's loss or plain squares.
  Descent descend(bool robust, int most_steps) {
    robust_ = robust;
    return levenberg_marquardt(*this, most_steps);
  }

  /// The loss of all edges; infinite where a point is not before its camera.
  double linearise() {
    equations_.reset(free_, static_cast<int>(problem_.points.size()));
    double cost = 0.0;
    for (std::size_t i = 0; i < problem_.edges.size(); ++i) {
      if (outlier_[i]) continue;
      const auto& edge = problem_.edges[i];
      const auto e = evaluate(edge);
      if (!e) return std::numeric_limits<double>::infinity();
      cost += e->pixel.cost + e->depth.cost;
      // ∂r/∂p has the rows (a 0 c), (0 b d) and (0 0 e).
      const double iz = 1.0 / e->p.z(), sx = e->scale * camera_.fx * iz, sy = e->scale * camera_.fy * iz;
      const double sz = edge.depth > 0 ? e->scale * disparity_ * iz * iz : 0.0;
      const double tx = -sx * e->p.x() * iz, ty = -sy * e->p.y() * iz;
      const double w = e->pixel.weight, wz = e->depth.weight;
      SightEquations sight;
      sight.p = e->p;
      sight.h << w * sx * sx, 0.0, w * sx * tx,  //
          0.0, w * sy * sy, w * sy * ty,         //
          w * sx * tx, w * sy * ty, w * (tx * tx + ty * ty) + wz * sz * sz;
      const Eigen::Vector3d& r = e->residual;
      sight.g << w * sx * r.x(), w * sy * r.y(), w * (tx * r.x() + ty * r.y()) + wz * sz * r.z();
      equations_.add(place_[static_cast<std::size_t>(edge.view)], edge.point,
                     problem_.views[static_cast<std::size_t>(edge.view)].camera_from_world.linear(), sight);
    }
    return cost;
  }

  double step(double damping) {
    if (!equations_.solve(damping, step_) || step_.cost_change >= 0) return 0.0;
    std::swap(equations_, equations_before_);
    poses_before_.clear(), points_before_.clear();
    for (std::size_t i = 0; i < problem_.views.size(); ++i) {
      Pose& pose = problem_.views[i].camera_from_world;
      poses_before_.push_back(pose);
      if (place_[i] != SchurEquations::kFixed)
        pose = normalised(se3_exp(step_.poses[static_cast<std::size_t>(place_[i])]) * pose);
    }
    for (std::size_t i = 0; i < problem_.points.size(); ++i) {
      points_before_.push_back(problem_.points[i].position);
      problem_.points[i].position += step_.points[i];
    }
    return -step_.cost_change;
  }

  void undo() {
    std::swap(equations_, equations_before_);
    for (std::size_t i = 0; i < problem_.views.size(); ++i)
      problem_.views[i].camera_from_world = poses_before_[i];
    for (std::size_t i = 0; i < problem_.points.size(); ++i) problem_.points[i].position = points_before_[i];
  }

  [[nodiscard]] bool converged(double cost, double next) const {
    return std::abs(cost - next) <= 1e-4 * cost;
  }

 private:
  /// An edge's residuals over their standard deviations, and what they cost.
  struct Evaluated {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();         // m, in the camera
    Eigen::Vector3d residual = Eigen::Vector3d::Zero();  // pixel, and depth as disparity
    double scale = 0.0;                                  // 1 / px
    Loss pixel, depth;
  };

  /// Nothing where the point is not before the camera.
  [[nodiscard]] std::optional<Evaluated> evaluate(const BundleProblem::Edge& edge) const {
    Evaluated e;
    e.p = problem_.views[static_cast<std::size_t>(edge.view)].camera_from_world *
          problem_.points[static_cast<std::size_t>(edge.point)].position;
    if (!(e.p.z() >= kNearestProjected)) return std::nullopt;
    const double iz = 1.0 / e.p.z();
    e.scale = std::sqrt(edge.static_weight) / edge.sigma_px;
    e.residual.x() = e.scale * (camera_.fx * e.p.x() * iz + camera_.cx - edge.pixel.x());
    e.residual.y() = e.scale * (camera_.fy * e.p.y() * iz + camera_.cy - edge.pixel.y());
    if (edge.depth > 0) e.residual.z() = e.scale * disparity_ * (1.0 / edge.depth - iz);
    e.pixel = huber(e.residual.head<2>().squaredNorm(), kChi2Pixel, robust_);
    e.depth = huber(e.residual.z() * e.residual.z(), kChi2Depth, robust_);
    return e;
  }

  BundleProblem& problem_;
  const std::vector<std::uint8_t>& outlier_;
  const Camera& camera_;
  double depth_weight_;
  double disparity_ = depth_weight_ * camera_.baseline_or(kDepthBaseline) * camera_.fx;  // px m
  bool robust_ = true;
  int free_ = 0;
  std::vector<int> place_;  // of each view among the free ones, or SchurEquations::kFixed
  SchurEquations equations_, equations_before_;
  SchurEquations::Step step_;
  std::vector<Pose> poses_before_;
  std::vector<Eigen::Vector3d> points_before_;
};

}  // namespace

BundleProblem make_bundle_problem(const LocalMap& map, int keyframe, const Config& config) {
  BundleProblem problem;
  std::map<int, int> view_of;  // keyframe -> index into views
  const auto add_view = [&](int id, bool fixed) {
    view_of[id] = static_cast<int>(problem.views.size());
    problem.views.push_back({id, map.keyframe(id).camera_from_world, fixed});
  };
  add_view(keyframe, false);
  for (const auto& [neighbour, shared] : map.covisible(keyframe)) {
    if (static_cast<int>(problem.views.size()) >= config.bundle.max_keyframes) break;
    add_view(neighbour, false);
  }

  std::vector<int> points;
  for (const auto& view : problem.views)
    for (const int point : map.keyframe(view.keyframe).points)
      if (point != kNone) points.push_back(point);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());

  int fixed = 0;
  for (const auto& [observer, seen] : map.observers(points)) {
    if (view_of.contains(observer)) continue;
    if (fixed++ >= config.bundle.max_fixed_keyframes) break;
    add_view(observer, true);
  }
  if (fixed == 0) {  // nothing else holds the map in place: its oldest keyframe does
    auto oldest = std::min_element(problem.views.begin(), problem.views.end(),
                                   [](const auto& a, const auto& b) { return a.keyframe < b.keyframe; });
    oldest->fixed = true;
  }

  const std::vector<double> scales = octave_scales(config.features);
  std::vector<BundleProblem::Edge> seen;
  for (const int id : points) {
    const MapPoint& point = map.point(id);
    const int index = static_cast<int>(problem.points.size());
    seen.clear();
    for (const Observation& o : point.observations) {
      const auto view = view_of.find(o.keyframe);
      if (view == view_of.end()) continue;
      const FeatureSet& features = *map.keyframe(o.keyframe).features;
      const auto f = static_cast<std::size_t>(o.feature);
      seen.push_back({view->second,
                      index,
                      {features.undistorted[f].x, features.undistorted[f].y},
                      features.depth[f],
                      scales[static_cast<std::size_t>(features.keypoints[f].octave)],
                      features.static_weight[f]});
    }
    if (seen.size() == 1) {  // says nothing of any pose, and goes where its view goes
      const Pose& camera_from_world = problem.views[static_cast<std::size_t>(seen[0].view)].camera_from_world;
      problem.carried.push_back({id, seen[0].view, camera_from_world * point.position});
      continue;
    }
    problem.points.push_back({id, point.position});
    problem.edges.insert(problem.edges.end(), seen.begin(), seen.end());
  }
  return problem;
}

BundleSolution solve_bundle(BundleProblem problem, const Camera& camera, const BundleConfig& config,
                            double depth_weight) {
  BundleSolution solution;
  solution.outlier.assign(problem.edges.size(), 0);
  solution.problem = std::move(problem);
  BundleProblem& moved = solution.problem;
  const bool any_free =
      std::any_of(moved.views.begin(), moved.views.end(), [](const auto& v) { return !v.fixed; });
  if (!any_free || moved.edges.empty()) return solution;
  solution.initial_rms_px = rms(moved, solution.outlier, camera);

  const auto mark_outliers = [&] {
    for (std::size_t i = 0; i < moved.edges.size(); ++i) {
      const bool depth = moved.edges[i].depth > 0 && depth_weight > 0;
      solution.outlier[i] = edge_error(moved, moved.edges[i], camera, depth_weight).chi2 >
                            (depth ? kChi2PixelDepth : kChi2Pixel);
    }
  };
  const int half = std::max(1, config.iterations / 2);
  BundleDescent solver(moved, solution.outlier, camera, depth_weight);
  for (const bool robust : {true, false}) {
    const Descent descent = solver.descend(robust, robust ? half : config.iterations);
    if (!descent.begun) return solution;
    solution.iterations += descent.taken;
    mark_outliers();
  }
  solution.rms_px = rms(moved, solution.outlier, camera);
  solution.usable = true;
  return solution;
}

void apply_bundle(const BundleSolution& solution, LocalMap& map) {
  if (!solution.usable) return;
  const BundleProblem& problem = solution.problem;
  for (const auto& view : problem.views)
    if (!view.fixed && map.has_keyframe(view.keyframe))
      map.keyframe(view.keyframe).camera_from_world = view.camera_from_world;
  for (const auto& point : problem.points)
    if (map.has_point(point.point)) map.point(point.point).position = point.position;
  for (const auto& carried : problem.carried) {
    const auto& view = problem.views[static_cast<std::size_t>(carried.view)];
    if (!view.fixed && map.has_point(carried.point))
      map.point(carried.point).position = view.camera_from_world.inverse() * carried.position_in_camera;
  }
  for (std::size_t i = 0; i < problem.edges.size(); ++i) {
    if (!solution.outlier[i]) continue;
    const int point = problem.points[static_cast<std::size_t>(problem.edges[i].point)].point;
    const int keyframe = problem.views[static_cast<std::size_t>(problem.edges[i].view)].keyframe;
    if (map.has_point(point) && map.has_keyframe(keyframe)) map.remove_observation(point, keyframe);
  }
}

}  // namespace stillpoint
