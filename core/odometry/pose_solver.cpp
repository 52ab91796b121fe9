#include "core/odometry/pose_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "core/geometry/levenberg_marquardt.hpp"
#include "core/geometry/normal_equations.hpp"
#include "core/odometry/adaptive_kernel.hpp"

namespace stillpoint {
namespace {

#if defined(__x86_64__)
// Without fused multiplication, which rounds otherwise; all that is called in it is compiled the same way.
#define STILLPOINT_FOUR_AT_ONCE [[gnu::target("avx2"), gnu::flatten]]
#else
#define STILLPOINT_FOUR_AT_ONCE
#endif

/// Four observations side by side: the same arithmetic on each, in one order on every processor.
constexpr std::size_t kLanes = 4;
/// Code for wide lanes counts on their alignment, which other code does not give by itself; std::array would
/// forget it.
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double)), aligned(kLanes * sizeof(double))));

constexpr int kFewestInliers = 6;  // that a pose is sought from

struct NormalEquations {
  Matrix6d h = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double cost = 0.0;
};

/// The observations as the sums over them want them: four in a block, the last filled up with ones that count
/// nothing.
class PoseProblem {
 public:
  PoseProblem(const Camera& camera, const std::vector<PoseObservation>& observations, double depth_weight,
              bool wide)
      : camera_(camera), wide_(wide), count_(observations.size()), blocks_((count_ + kLanes - 1) / kLanes) {
    for (std::size_t i = 0; i < count_; ++i) {
      const PoseObservation& o = observations[i];
      Block& block = blocks_[i / kLanes];
      const std::size_t k = i % kLanes;
      for (int axis = 0; axis < 3; ++axis) block.point[axis][k] = o.point_in_world[axis];
      block.u[k] = o.pixel.x(), block.v[k] = o.pixel.y();
      block.weight[k] = 1.0 / o.sigma_px;
      const bool depth = depth_weight > 0 && o.depth > 0;
      block.inverse_depth[k] = depth ? 1.0 / o.depth : 0.0;
      block.depth_weight[k] =
          depth ? depth_weight * camera.baseline_or(kDepthBaseline) * camera.fx / o.sigma_px : 0.0;
      block.bound[k] = depth ? kChi2PixelDepth : kChi2Pixel;
      block.static_weight[k] = block.used[k] = o.static_weight;
    }
  }

  /// Which observations the sums go over.
  void use(const std::vector<std::uint8_t>& inlier) {
    for (std::size_t i = 0; i < count_; ++i) {
      Block& block = blocks_[i / kLanes];
      block.used[i % kLanes] = inlier[i] != 0 ? block.static_weight[i % kLanes] : 0.0;
    }
  }

  /// How many numbers the sums go over, each as far as it counts.
  [[nodiscard]] double rows() const {
    double rows = 0.0;
    for (const Block& block : blocks_)
      for (std::size_t k = 0; k < kLanes; ++k)
        rows += block.used[k] * (block.depth_weight[k] > 0 ? 3.0 : 2.0);
    return rows;
  }

  /// Marks the observations whose χ² is within so many times its bound; returns how many.
  int mark_inliers(const Pose& camera_from_world, double gate, std::vector<std::uint8_t>& inlier) const {
    int inliers = 0;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Residual r = residual(blocks_[b], camera_from_world);
      for (std::size_t k = 0; k < kLanes && b * kLanes + k < count_; ++k) {
        const bool within = r.in_front[k] > 0 && r.chi2[k] <= gate * blocks_[b].bound[k];
        inlier[b * kLanes + k] = within;
        inliers += within;
      }
    }
    return inliers;
  }

  /// Gauss-Newton's equations by a left perturbation, translation first. With `robust`, Huber's weights.
  /// … or, with an adaptive kernel, that one's.
  [[nodiscard]] NormalEquations normal_equations(const Pose& camera_from_world, bool robust) const {
    return wide_ ? summed_wide(camera_from_world, robust) : summed(camera_from_world, robust);
  }

  /// Takes the shape of loss under which the residuals are likeliest, for the sums that are robust.
  void adapt_kernel(const Pose& camera_from_world) {
    std::vector<double> squares;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Residual r = residual(blocks_[b], camera_from_world);
      for (std::size_t k = 0; k < kLanes && b * kLanes + k < count_; ++k)
        if (r.in_front[k] > 0 && blocks_[b].used[k] > 0) squares.push_back(r.chi2[k]);
    }
    kernel_ = AdaptiveKernel::likeliest(squares);
  }

 private:
  struct Block {
    Lanes point[3] = {};  // m, world
    Lanes u{}, v{}, inverse_depth{};
    Lanes weight{};        // 1/σ, so that squared norms are χ²
    Lanes depth_weight{};  // of the third residual, depth as disparity; 0 without depth
    Lanes bound{}, static_weight{}, used{};
  };
  static_assert(alignof(Block) == sizeof(Lanes));
  /// Residuals by weight, and where the points lie in the camera.
  struct Residual {
    Lanes x, y, z, inverse_z;
    Lanes by_u, by_v, by_depth, chi2;
    Lanes in_front;  // 1 or 0
  };

  STILLPOINT_FOUR_AT_ONCE [[nodiscard]] NormalEquations summed_wide(const Pose& camera_from_world,
                                                                    bool robust) const {
    return summed(camera_from_world, robust);
  }

  [[nodiscard]] NormalEquations summed(const Pose& camera_from_world, bool robust) const {
    Lanes sums[27] = {};  // upper triangle of h row by row, then g
    Lanes costs{};
    for (const Block& block : blocks_) {
      const Residual r = residual(block, camera_from_world);
      Lanes weight = r.in_front * block.used, cost = r.chi2;
      if (robust && kernel_)
        for (std::size_t k = 0; k < kLanes; ++k) {
          cost[k] = 2.0 * kernel_->cost(r.chi2[k]);
          weight[k] *= kernel_->weight(r.chi2[k]);
        }
      else if (robust)
        for (std::size_t k = 0; k < kLanes; ++k)
          if (r.chi2[k] > block.bound[k]) {
            const double share = std::sqrt(block.bound[k] / r.chi2[k]);
            cost[k] = 2.0 * share * r.chi2[k] - block.bound[k];
            weight[k] *= share;
          }
      costs += r.in_front * block.used * cost;
      add(block, r, weight, sums);
    }
    NormalEquations n;
    const auto total = [](const Lanes& l) { return (l[0] + l[1]) + (l[2] + l[3]); };
    std::size_t entry = 0;
    for (int row = 0; row < 6; ++row)
      for (int column = row; column < 6; ++column) n.h(row, column) = n.h(column, row) = total(sums[entry++]);
    for (int row = 0; row < 6; ++row) n.g[row] = total(sums[entry++]);
    n.cost = total(costs);
    return n;
  }

  [[nodiscard]] Residual residual(const Block& block, const Pose& pose) const {
    const auto& m = pose.matrix();
    const auto& p = block.point;
    Residual r;
    r.x = m(0, 0) * p[0] + m(0, 1) * p[1] + m(0, 2) * p[2] + m(0, 3);
    r.y = m(1, 0) * p[0] + m(1, 1) * p[1] + m(1, 2) * p[2] + m(1, 3);
    r.z = m(2, 0) * p[0] + m(2, 1) * p[1] + m(2, 2) * p[2] + m(2, 3);
    for (std::size_t k = 0; k < kLanes; ++k) r.in_front[k] = r.z[k] > kNearestProjected ? 1.0 : 0.0;
    for (std::size_t k = 0; k < kLanes; ++k) r.inverse_z[k] = 1.0 / std::max(r.z[k], kNearestProjected);
    r.by_u = block.weight * (camera_.fx * r.x * r.inverse_z + camera_.cx - block.u);
    r.by_v = block.weight * (camera_.fy * r.y * r.inverse_z + camera_.cy - block.v);
    r.by_depth = block.depth_weight * (block.inverse_depth - r.inverse_z);
    r.chi2 = r.by_u * r.by_u + r.by_v * r.by_v + r.by_depth * r.by_depth;
    return r;
  }

  /// Adds J^T w J and J^T w r. The rows of J are (a 0 c | cy az-cx -ay), (0 b d | dy-bz -dx bx) and
  /// (0 0 e | ey -ex 0).
  void add(const Block& block, const Residual& r, const Lanes& weight, Lanes (&sums)[27]) const {
    const Lanes a = block.weight * camera_.fx * r.inverse_z, b = block.weight * camera_.fy * r.inverse_z;
    const Lanes c = -a * r.x * r.inverse_z, d = -b * r.y * r.inverse_z;
    const Lanes e = block.depth_weight * r.inverse_z * r.inverse_z;
    const Lanes u3 = c * r.y, u4 = a * r.z - c * r.x, u5 = -a * r.y;
    const Lanes v3 = d * r.y - b * r.z, v4 = -d * r.x, v5 = b * r.x;
    const Lanes d3 = e * r.y, d4 = -e * r.x;
    const Lanes wa = weight * a, wc = weight * c, wu3 = weight * u3, wu4 = weight * u4, wu5 = weight * u5;
    const Lanes wb = weight * b, wd = weight * d, wv3 = weight * v3, wv4 = weight * v4, wv5 = weight * v5;
    const Lanes we = weight * e, wd3 = weight * d3, wd4 = weight * d4;
    sums[0] += wa * a, sums[2] += wa * c, sums[3] += wa * u3, sums[4] += wa * u4, sums[5] += wa * u5;
    sums[6] += wb * b, sums[7] += wb * d, sums[8] += wb * v3, sums[9] += wb * v4, sums[10] += wb * v5;
    sums[11] += wc * c + wd * d + we * e, sums[12] += wc * u3 + wd * v3 + we * d3;
    sums[13] += wc * u4 + wd * v4 + we * d4, sums[14] += wc * u5 + wd * v5;
    sums[15] += wu3 * u3 + wv3 * v3 + wd3 * d3, sums[16] += wu3 * u4 + wv3 * v4 + wd3 * d4;
    sums[17] += wu3 * u5 + wv3 * v5;
    sums[18] += wu4 * u4 + wv4 * v4 + wd4 * d4, sums[19] += wu4 * u5 + wv4 * v5;
    sums[20] += wu5 * u5 + wv5 * v5;
    sums[21] += wa * r.by_u, sums[22] += wb * r.by_v;
    sums[23] += wc * r.by_u + wd * r.by_v + we * r.by_depth;
    sums[24] += wu3 * r.by_u + wv3 * r.by_v + wd3 * r.by_depth;
    sums[25] += wu4 * r.by_u + wv4 * r.by_v + wd4 * r.by_depth;
    sums[26] += wu5 * r.by_u + wv5 * r.by_v;
  }

  const Camera& camera_;
  bool wide_;
  std::size_t count_;
  std::vector<Block> blocks_;
  std::optional<AdaptiveKernel> kernel_;  // none: Huber's
};

/// A pose on its way to the least cost over the observations in use.
class PoseDescent {
 public:
  PoseDescent(const PoseProblem& problem, bool robust, const Pose& start)
      : problem_(problem), robust_(robust), pose_(start) {}

  double linearise() {
    equations_ = problem_.normal_equations(pose_, robust_);
    return equations_.cost;
  }
  double step(double damping) {
    pose_before_ = pose_, before_ = equations_;
    const Vector6d added = damping * equations_.h.diagonal() + Vector6d::Constant(1e-9);
    Matrix6d damped = equations_.h;
    damped.diagonal() += added;
    change_ = -solve_ldlt(damped, equations_.g);
    const double foreseen = added.dot(change_.cwiseAbs2()) - equations_.g.dot(change_);
    if (foreseen > 0) pose_ = se3_exp(change_) * pose_;
    return foreseen;
  }
  void undo() { pose_ = pose_before_, equations_ = before_; }
  [[nodiscard]] bool converged(double, double) const {
    return change_.norm() < 1e-7;  // m and rad: far below what pixels can tell
  }
  [[nodiscard]] const Pose& pose() const { return pose_; }

 private:
  const PoseProblem& problem_;
  bool robust_;
  Pose pose_, pose_before_ = pose_;
  NormalEquations equations_, before_;
  Vector6d change_ = Vector6d::Zero();
};

}  // namespace

Matrix6d PoseRefinement::covariance() const {
  Matrix6d covariance;
  for (int i = 0; i < 6; ++i) covariance.col(i) = solve_ldlt(information, Vector6d(Vector6d::Unit(i)));
  // Each column is solved by itself; of their halves that should be the same the mean.
  covariance = Matrix6d(0.5 * noise * noise * (covariance + covariance.transpose()));
  const bool told = covariance.allFinite() && covariance.diagonal().minCoeff() > 0;
  return told ? covariance : Matrix6d(Matrix6d::Zero());
}

PoseRefinement refine_pose(const Camera& camera, const std::vector<PoseObservation>& observations,
                           const Pose& initial_camera_from_world, const TrackingConfig& config,
                           double start_gate, bool wide) {
  PoseRefinement result;
  result.camera_from_world = initial_camera_from_world;
  result.inlier.assign(observations.size(), 1);
  result.residual_px.assign(observations.size(), 0.0F);
  if (observations.size() < 3) {
    result.inlier.assign(observations.size(), 0);
    return result;
  }
  PoseProblem problem(camera, observations, config.depth_weight, wide);
  if (start_gate > 0 &&
      problem.mark_inliers(initial_camera_from_world, start_gate, result.inlier) >= config.min_inliers)
    problem.use(result.inlier);
  for (int round = 0; round < config.refine_rounds; ++round) {
    // Robust while outliers are still among the inliers; plain least squares once they are told apart.
    const bool robust = round < 2;
    if (robust && config.adaptive_kernel) problem.adapt_kernel(result.camera_from_world);
    PoseDescent descent(problem, robust, result.camera_from_world);
    result.iterations += levenberg_marquardt(descent, config.refine_iterations).tried;
    result.camera_from_world = descent.pose();
    result.inliers = problem.mark_inliers(result.camera_from_world, 1.0, result.inlier);
    problem.use(result.inlier);
    if (result.inliers < kFewestInliers) break;
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
  const NormalEquations last = problem.normal_equations(result.camera_from_world, false);
  result.information = last.h;
  result.noise = std::sqrt(last.cost / std::max(1.0, problem.rows() - 6.0));
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
