#include "core/odometry/dso/coarse_tracker.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/geometry/normal_equations.hpp"
#include "core/geometry/pixel_conventions.hpp"

namespace stillpoint {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

constexpr std::array<int, 5> kIterations = {10, 20, 50, 50, 50};  // at most, finest first: DSO's

struct State {
  Pose frame_from_reference = Pose::Identity();
  Affine affine;
};

/// Residuals of one level under one state, and their normal equations.
struct Compared {
  Matrix8d h = Matrix8d::Zero();
  Vector8d b = Vector8d::Zero();
  double energy = 0.0;
  int in_view = 0, cut = 0;
  [[nodiscard]] double mean_energy() const {
    return in_view > 0 ? energy / in_view : std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] double cut_share() const { return in_view > 0 ? static_cast<double>(cut) / in_view : 1.0; }
};

/// Tracks one frame level by level.
class Way {
 public:
  Way(const CoarseReference& reference, const DsoImage& frame, const TrackerFrame& looked,
      const DsoConfig& config)
      : reference_(reference), frame_(frame), looked_(looked), config_(config) {}

  /// From coarse to fine. @returns the finest level's mean energy; infinite where it fails
  double run(State& state, double worst, int& iterations, double& cutoff) {
    double mean = std::numeric_limits<double>::infinity();
    const int levels = static_cast<int>(std::min(reference_.levels.size(), frame_.levels.size()));
    for (int level = levels - 1; level >= 0; --level) {
      mean = run_level(level, state, iterations, cutoff);
      // No finer level mends what is far off at a coarser one.
      if (!std::isfinite(mean) || std::sqrt(mean) > worst) return std::numeric_limits<double>::infinity();
    }
    return mean;
  }

  /// @param equations null where residuals alone are wanted; @param seen filled where it is not null
  void compare(int level, const State& state, double cutoff, bool equations, Compared& sum,
               CoarseAlignment* seen = nullptr) const {
    const auto at = static_cast<std::size_t>(level);
    const cv::Mat& image = frame_.levels[at];
    const Camera& camera = frame_.cameras[at];
    const DsoTransfer transfer(camera, state.frame_from_reference, reference_.velocity, looked_.velocity);
    const double gain = std::exp(state.affine.a - reference_.affine.a);
    for (const CoarsePoint& point : reference_.levels[at]) {
      const auto place = transfer(point.u, point.v, point.inverse_depth);
      if (!place || !inside(image, place->x, place->y, 1)) continue;
      const float weight = point.weight * weight_of(point, place->x, place->y, level);
      if (seen != nullptr) {
        seen->points.push_back(point);
        seen->points.back().u = place->x;
        seen->points.back().v = place->y;
        seen->points.back().weight = weight;
        seen->residuals.push_back(std::numeric_limits<float>::quiet_NaN());
      }
      if (weight <= 0.0F) continue;
      ++sum.in_view;
      const cv::Vec3f shown = sample(image, place->x, place->y);
      const double was = static_cast<double>(point.brightness) - reference_.affine.b;
      const double r = photometric_residual(static_cast<double>(shown[0]), state.affine,
                                            static_cast<double>(point.brightness), reference_.affine);
      if (seen != nullptr) seen->residuals.back() = static_cast<float>(r);
      if (std::abs(r) > cutoff) {
        ++sum.cut;
        sum.energy += config_.huber * (2.0 * cutoff - config_.huber);
        continue;
      }
      const double huber = huber_weight(r, config_.huber);
      sum.energy += huber * r * r * (2.0 - huber);
      if (!equations) continue;
      const Eigen::Vector3d& p = place->in_target;
      const double iz = 1.0 / p.z();
      const double jx = static_cast<double>(shown[1]) * camera.fx * iz,
                   jy = static_cast<double>(shown[2]) * camera.fy * iz;
      const Eigen::Vector3d by_point(jx, jy, -(jx * p.x() + jy * p.y()) * iz);
      Vector8d j;
      j << by_point, p.cross(by_point), -gain * was, -1.0;
      const double w = huber * static_cast<double>(weight);
      sum.h.noalias() += w * j * j.transpose();
      sum.b.noalias() += w * r * j;
    }
  }

 private:
  [[nodiscard]] float weight_of(const CoarsePoint& point, double x, double y, int level) const {
    float weight = 1.0F;
    if (!looked_.weight.empty()) {
      const int u = static_cast<int>(std::lround(upsampled(x, 1 << level))),
                v = static_cast<int>(std::lround(upsampled(y, 1 << level)));
      weight = looked_.weight.at<float>(std::clamp(v, 0, looked_.weight.rows - 1),
                                        std::clamp(u, 0, looked_.weight.cols - 1));
    }
    if (point.id >= 0 && !looked_.point_weight.empty())
      if (const auto known = looked_.point_weight.find(point.id); known != looked_.point_weight.end())
        weight *= known->second;
    return weight;
  }

  double run_level(int level, State& state, int& iterations, double& cutoff) {
    // The damping begins at kFirst and goes by factors, as in DSO. Ends: a gain that is no larger share of
    // the energy, a step of fewer m and rad at full size.
    constexpr double kWorse = 4.0, kBetter = 0.5, kFirst = 0.01, kLeastGain = 1e-5, kStill = 2e-5,
                     kMostCutoffs = 3;
    cutoff = config_.cutoff;
    Compared now;
    for (int doubled = 0;; ++doubled) {
      now = {};
      compare(level, state, cutoff, true, now);
      if (now.in_view < std::max(10, config_.min_points >> (2 * level)))
        return std::numeric_limits<double>::infinity();
      if (now.cut_share() <= config_.cutoff_share || doubled >= kMostCutoffs) break;
      cutoff *= 2.0;
    }
    double damping = kFirst;
    const int most =
        kIterations[static_cast<std::size_t>(std::min(level, static_cast<int>(kIterations.size()) - 1))];
    for (int i = 0; i < most; ++i) {
      Matrix8d h = now.h;
      for (int d = 0; d < 8; ++d) h(d, d) = h(d, d) * (1.0 + damping) + 1e-9;
      const Vector8d scale = h.diagonal().cwiseSqrt().cwiseInverse();
      const Matrix8d scaled = scale.asDiagonal() * h * scale.asDiagonal();
      const Vector8d change =
          -(scale.asDiagonal() * solve_ldlt(scaled, Vector8d(scale.asDiagonal() * now.b)));
      if (!change.allFinite()) break;
      State moved = state;
      moved.frame_from_reference = normalised(se3_exp(change.head<6>()) * state.frame_from_reference);
      moved.affine.a += change[6];
      moved.affine.b += change[7];
      Compared next;
      compare(level, moved, cutoff, true, next);
      if (next.in_view > 0 && next.mean_energy() < now.mean_energy()) {
        const double gained = 1.0 - next.mean_energy() / now.mean_energy();
        state = moved;
        now = next;
        damping *= kBetter;
        ++iterations;
        if (gained < kLeastGain) break;
      } else {
        damping = std::max(damping, kFirst) * kWorse;
      }
      if (change.head<6>().norm() < std::ldexp(kStill, level)) break;
    }
    return now.mean_energy();
  }

  const CoarseReference& reference_;
  const DsoImage& frame_;
  const TrackerFrame& looked_;
  const DsoConfig& config_;
};

/// How far the points go between the keyframe and the frame, per coordinate, at 640x480.
void measure_flow(const CoarseReference& reference, const Pose& frame_from_reference, const Camera& camera,
                  CoarseAlignment& result) {
  Pose shift = frame_from_reference;
  shift.linear().setIdentity();
  double shifted = 0.0, flown = 0.0;
  int count = 0;
  for (const CoarsePoint& point : reference.levels.front()) {
    const Eigen::Vector3d p = camera.back_project({point.u, point.v}, 1.0 / point.inverse_depth);
    const Eigen::Vector3d by_shift = shift * p, whole = frame_from_reference * p;
    if (by_shift.z() < 0.1 || whole.z() < 0.1) continue;
    const Eigen::Vector2d from(point.u, point.v);
    shifted += (camera.project(by_shift) - from).squaredNorm();
    flown += (camera.project(whole) - from).squaredNorm();
    count += 2;
  }
  if (count == 0) return;
  const double at_vga = (640.0 + 480.0) / (camera.width + camera.height);
  result.shift_px = at_vga * std::sqrt(shifted / count);
  result.flow_px = at_vga * std::sqrt(flown / count);
}

}  // namespace

CoarseReference make_coarse_reference(const DsoWindow& window, const Camera& camera) {
  CoarseReference reference;
  const DsoFrame& newest = window.frames.back();
  reference.keyframe = newest.keyframe;
  reference.frame_index = newest.frame_index;
  reference.camera_from_world = newest.camera_from_world;
  reference.affine = newest.affine;
  reference.velocity = newest.velocity;
  const std::size_t count = newest.image->levels.size();
  reference.levels.resize(count);
  std::vector<cv::Mat> sums;  // of inverse depth, how many, and weight: one pixel may hold several points
  for (const cv::Mat& level : newest.image->levels)
    sums.emplace_back(level.size(), CV_32FC3, cv::Scalar(0, 0, 0));
  for (const DsoPoint& point : window.points) {
    const int host = window.index_of(point.host);
    if (host < 0) continue;
    const DsoFrame& from = window.frames[static_cast<std::size_t>(host)];
    double x = point.u, y = point.v, inverse_depth = point.inverse_depth;
    if (from.keyframe != newest.keyframe) {
      if (point.seen == 0) continue;
      const DsoTransfer transfer(camera, newest.camera_from_world * from.camera_from_world.inverse(),
                                 from.velocity, newest.velocity);
      const auto place = transfer(point.u, point.v, point.inverse_depth);
      if (!place) continue;
      x = std::round(place->x), y = std::round(place->y), inverse_depth = 1.0 / place->in_target.z();
    }
    const cv::Mat& image = newest.image->levels.front();
    if (!inside(image, x, y, kDsoReach)) continue;
    const int u = static_cast<int>(x), v = static_cast<int>(y);
    if (!newest.weight.empty() && newest.weight.at<float>(v, u) <= 0.0F) continue;
    reference.levels.front().push_back(
        {x, y, inverse_depth, image.at<cv::Vec3f>(v, u)[0], point.static_weight, point.id});
    for (std::size_t level = 1; level < count; ++level) {
      auto& sum = sums[level].at<cv::Vec3f>(std::min(v >> level, sums[level].rows - 1),
                                            std::min(u >> level, sums[level].cols - 1));
      sum += cv::Vec3f(static_cast<float>(inverse_depth), 1.0F, point.static_weight);
    }
  }
  for (std::size_t level = 1; level < count; ++level)
    for (int y = 1; y + 1 < sums[level].rows; ++y)
      for (int x = 1; x + 1 < sums[level].cols; ++x) {
        // As DSO does, a pixel without a point takes after its neighbours.
        cv::Vec3f sum = sums[level].at<cv::Vec3f>(y, x);
        if (sum[1] == 0.0F)
          for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
            sum += sums[level].at<cv::Vec3f>(y + dy, x + dx);
        if (sum[1] == 0.0F) continue;
        reference.levels[level].push_back(
            {static_cast<double>(x), static_cast<double>(y), static_cast<double>(sum[0] / sum[1]),
             newest.image->levels[level].at<cv::Vec3f>(y, x)[0], sum[2] / sum[1], -1});
      }
  return reference;
}

std::vector<Pose> dso_starts(const Pose& predicted, const Pose& last, const Pose& reference, double turn) {
  const Pose from_reference = predicted * reference.inverse(),
             last_from_reference = last * reference.inverse();
  const Pose motion = predicted * last.inverse();
  std::vector<Pose> starts{from_reference, motion * from_reference,
                           se3_exp(0.5 * se3_log(motion)) * last_from_reference, last_from_reference,
                           Pose::Identity()};
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        Vector6d xi = Vector6d::Zero();
        xi.tail<3>() = turn * Eigen::Vector3d(x, y, z);
        starts.push_back(se3_exp(xi) * from_reference);
      }
  return starts;
}

CoarseAlignment track_coarse(const CoarseReference& reference, const DsoImage& frame,
                             const TrackerFrame& looked, const std::vector<Pose>& starts,
                             const Affine& affine, double usual, const DsoConfig& config) {
  CoarseAlignment best;
  best.rmse = std::numeric_limits<double>::infinity();
  State won;
  Way way(reference, frame, looked, config);
  const double wanted = config.good_enough * usual;
  for (const Pose& start : starts) {
    State state{start, affine};
    int iterations = 0;
    double cutoff = 0.0;
    ++best.tries;
    const double energy = way.run(state, config.good_enough * best.rmse, iterations, cutoff);
    const bool believable = std::isfinite(energy) &&
                            std::abs(state.affine.a - reference.affine.a) <= config.max_gain &&
                            std::abs(state.affine.b - reference.affine.b) <= config.max_bias;
    if (believable && std::sqrt(energy) < best.rmse) {
      best.rmse = std::sqrt(energy);
      best.iterations = iterations;
      best.cutoff = cutoff;
      won = state;
    }
    if (std::isfinite(best.rmse) && best.rmse < wanted) break;
  }
  if (!std::isfinite(best.rmse)) {
    best.failure = fmt::format("none of {} starts leads to where {} points show the brightness they should",
                               best.tries, config.min_points);
    return best;
  }
  best.frame_from_reference = won.frame_from_reference;
  best.affine = won.affine;
  Compared sum;
  way.compare(0, won, best.cutoff, false, sum, &best);
  best.inliers = sum.in_view - sum.cut;
  measure_flow(reference, won.frame_from_reference, frame.cameras.front(), best);
  if (best.inliers < config.min_points)
    best.failure =
        fmt::format("{} points show the brightness they should; {} must", best.inliers, config.min_points);
  return best;
}

}  // namespace stillpoint
