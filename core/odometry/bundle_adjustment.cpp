#include "core/odometry/bundle_adjustment.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>

#include "core/odometry/matching.hpp"
#include "core/odometry/pose_solver.hpp"

namespace stillpoint {
namespace {

constexpr double kChi2Depth = 3.841;  // 95 % bound with one degree of freedom

using PoseBlock = std::array<double, 7>;  // unit quaternion x y z w, then translation: camera_from_world

/// camera_from_world moved by exp(ξ^) from the left. Costs give their Jacobian by ξ in the first six columns,
/// so the manifold's own Jacobian only selects them.
class PoseManifold : public ceres::Manifold {
 public:
  [[nodiscard]] int AmbientSize() const override { return 7; }
  [[nodiscard]] int TangentSize() const override { return 6; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Eigen::Map<const Eigen::Quaterniond> q(x);
    const Eigen::Map<const Eigen::Vector3d> t(x + 4);
    const Pose motion = se3_exp(Eigen::Map<const Vector6d>(delta));
    Eigen::Map<Eigen::Quaterniond> q_moved(x_plus_delta);
    Eigen::Map<Eigen::Vector3d> t_moved(x_plus_delta + 4);
    const Eigen::Vector3d translation = motion * t;
    q_moved = (Eigen::Quaterniond(motion.linear()) * q).normalized();
    t_moved = translation;
    return true;
  }

  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> j(jacobian);
    j.setZero();
    j.topRows<6>().setIdentity();
    return true;
  }

  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d> difference(y_minus_x);
    difference = se3_log(pose(y) * pose(x).inverse());
    return true;
  }

  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> j(jacobian);
    j.setZero();
    j.leftCols<6>().setIdentity();
    return true;
  }

  static Pose pose(const double* block) {
    Pose result = Pose::Identity();
    result.linear() = Eigen::Map<const Eigen::Quaterniond>(block).toRotationMatrix();
    result.translation() = Eigen::Map<const Eigen::Vector3d>(block + 4);
    return result;
  }
};

/// One half of an observation's residual, each over its standard deviation: the pixel, or the measured depth
/// as disparity. Both halves have two rows, the second of depth's being zero: Ceres' eliminator knows blocks
/// of one size at compile time, and takes half as long with them. An outlier counts nothing.
class ObservationCost : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  enum class Half : std::uint8_t { pixel, depth };

  ObservationCost(Half half, const Camera& camera, const BundleProblem::Edge& edge, double depth_weight,
                  const std::uint8_t& outlier)
      : half_(half), camera_(camera), edge_(edge), depth_weight_(depth_weight), outlier_(outlier) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    using Jacobian = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;
    Eigen::Map<Eigen::Vector2d> residual(residuals);
    Jacobian by_camera_point = Jacobian::Zero();
    const Eigen::Matrix3d rotation = Eigen::Map<const Eigen::Quaterniond>(parameters[0]).toRotationMatrix();
    const Eigen::Map<const Eigen::Vector3d> t(parameters[0] + 4), point(parameters[1]);
    const Eigen::Vector3d p = rotation * point + t;
    if (outlier_ != 0) {
      residual.setZero();
    } else if (p.z() < kNearestProjected) {
      return false;
    } else {
      const double weight = std::sqrt(edge_.static_weight) / edge_.sigma_px, iz = 1.0 / p.z();
      if (half_ == Half::pixel) {
        residual.x() = weight * (camera_.fx * p.x() * iz + camera_.cx - edge_.pixel.x());
        residual.y() = weight * (camera_.fy * p.y() * iz + camera_.cy - edge_.pixel.y());
        by_camera_point.row(0) << weight * camera_.fx * iz, 0, -weight * camera_.fx * p.x() * iz * iz;
        by_camera_point.row(1) << 0, weight * camera_.fy * iz, -weight * camera_.fy * p.y() * iz * iz;
      } else {
        const double bf = weight * depth_weight_ * camera_.baseline_or(kDepthBaseline) * camera_.fx;
        residual << bf * (1.0 / edge_.depth - iz), 0.0;
        by_camera_point(0, 2) = bf * iz * iz;
      }
    }
    if (!jacobians) return true;
    if (jacobians[0]) {
      Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> j(jacobians[0]);
      j.leftCols<3>() = by_camera_point;
      j.middleCols<3>(3) = -by_camera_point * hat(p);
      j.rightCols<1>().setZero();
    }
    if (jacobians[1]) {
      Eigen::Map<Jacobian> j(jacobians[1]);
      j = by_camera_point * rotation;
    }
    return true;
  }

 private:
  Half half_;
  const Camera& camera_;
  const BundleProblem::Edge& edge_;
  double depth_weight_;
  const std::uint8_t& outlier_;
};

/// Huber's loss while it is switched on, plain squares afterwards.
class SwitchedHuber : public ceres::LossFunction {
 public:
  SwitchedHuber(double bound, const bool& robust) : huber_(bound), robust_(robust) {}
  void Evaluate(double squared, double out[3]) const override {
    if (robust_) return huber_.Evaluate(squared, out);
    out[0] = squared, out[1] = 1.0, out[2] = 0.0;
  }

 private:
  ceres::HuberLoss huber_;
  const bool& robust_;
};

PoseBlock to_block(const Pose& pose) {
  PoseBlock block;
  Eigen::Map<Eigen::Quaterniond>(block.data()) = Eigen::Quaterniond(pose.linear()).normalized();
  Eigen::Map<Eigen::Vector3d>(block.data() + 4) = pose.translation();
  return block;
}

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

/// The problem as Ceres holds it; solved once robustly and once more without the outliers found meanwhile.
class BundleSolver {
 public:
  BundleSolver(BundleProblem& problem, const std::vector<std::uint8_t>& outlier, const Camera& camera,
               double depth_weight)
      : problem_(problem), ceres_problem_(ownership()) {
    poses_.reserve(problem.views.size());
    for (const auto& view : problem.views) poses_.push_back(to_block(view.camera_from_world));
    ordering_ = std::make_shared<ceres::ParameterBlockOrdering>();
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      ceres_problem_.AddParameterBlock(poses_[i].data(), 7, &manifold_);
      if (problem.views[i].fixed) ceres_problem_.SetParameterBlockConstant(poses_[i].data());
      ordering_->AddElementToGroup(poses_[i].data(), 1);
    }
    for (auto& point : problem.points) {
      ceres_problem_.AddParameterBlock(point.position.data(), 3);
      ordering_->AddElementToGroup(point.position.data(), 0);
    }
    using Half = ObservationCost::Half;
    for (std::size_t i = 0; i < problem.edges.size(); ++i) {
      const auto& edge = problem.edges[i];
      add(Half::pixel, camera, edge, depth_weight, outlier[i]);
      if (edge.depth > 0 && depth_weight > 0) add(Half::depth, camera, edge, depth_weight, outlier[i]);
    }
  }
  BundleSolver(const BundleSolver&) = delete;
  BundleSolver& operator=(const BundleSolver&) = delete;

  /// One Levenberg-Marquardt run over the edges that are no outliers; moves views and points. False if it
  /// failed.
  bool solve(bool robust, int max_iterations, int& iterations) {
    robust_ = robust;
    ceres::Solver::Options options;
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>(*ordering_);
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.max_num_iterations = max_iterations;
    options.num_threads = 1;  // sums in one order: the same bytes on any machine load
    options.function_tolerance = 1e-4;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &ceres_problem_, &summary);
    if (!summary.IsSolutionUsable()) return false;
    iterations += summary.num_successful_steps;
    for (std::size_t i = 0; i < poses_.size(); ++i)
      if (!problem_.views[i].fixed)
        problem_.views[i].camera_from_world = PoseManifold::pose(poses_[i].data());
    return true;
  }

 private:
  static ceres::Problem::Options ownership() {
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;  // blocks are distinct by construction
    return options;
  }

  void add(ObservationCost::Half half, const Camera& camera, const BundleProblem::Edge& edge,
           double depth_weight, const std::uint8_t& outlier) {
    costs_.emplace_back(half, camera, edge, depth_weight, outlier);
    ceres_problem_.AddResidualBlock(&costs_.back(),
                                    half == ObservationCost::Half::pixel ? &pixel_loss_ : &depth_loss_,
                                    poses_[static_cast<std::size_t>(edge.view)].data(),
                                    problem_.points[static_cast<std::size_t>(edge.point)].position.data());
  }

  BundleProblem& problem_;
  bool robust_ = true;
  PoseManifold manifold_;
  SwitchedHuber pixel_loss_{std::sqrt(kChi2Pixel), robust_}, depth_loss_{std::sqrt(kChi2Depth), robust_};
  std::vector<PoseBlock> poses_;
  std::deque<ObservationCost> costs_;  // never moved: Ceres points into it
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_;
  ceres::Problem ceres_problem_;  // last: it points into all of the above
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
  BundleSolver solver(moved, solution.outlier, camera, depth_weight);
  if (!solver.solve(true, half, solution.iterations)) return solution;
  mark_outliers();
  if (!solver.solve(false, config.iterations, solution.iterations)) return solution;
  mark_outliers();
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
