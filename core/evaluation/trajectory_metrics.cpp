#include "core/evaluation/trajectory_metrics.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/counted.hpp"
#include "core/geometry/rotation_fit.hpp"
#include "core/sequence/association.hpp"

namespace stillpoint {
namespace {

template <typename Error>
std::vector<double> column(const std::vector<Error>& errors, double Error::*member) {
  std::vector<double> values;
  values.reserve(errors.size());
  for (const Error& error : errors) values.push_back(error.*member);
  return values;
}

/// Below three poses an alignment leaves nothing over to be an error.
constexpr std::size_t kFewestToAlign = 3;

/// Umeyama's similarity of positions.
std::optional<SimilarityFit> similarity_fit(const std::vector<MatchedPose>& matched) {
  Eigen::Matrix3Xd from(3, matched.size()), to(3, matched.size());
  for (std::size_t i = 0; i < matched.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = matched[i].estimate.translation();
    to.col(static_cast<Eigen::Index>(i)) = matched[i].truth.translation();
  }
  from.colwise() -= Eigen::Vector3d(from.rowwise().mean());
  to.colwise() -= Eigen::Vector3d(to.rowwise().mean());
  const Eigen::Matrix3d sum = to * from.transpose();
  const Eigen::Matrix3d rotation = fit_rotation(sum).rotation;
  SimilarityFit result;
  result.scale = rotation.cwiseProduct(sum).sum() / from.squaredNorm();
  if (!std::isfinite(result.scale) || result.scale <= 0) return std::nullopt;
  const Eigen::Matrix3Xd left = result.scale * (rotation * from) - to;
  result.rmse_m = std::sqrt(left.colwise().squaredNorm().mean());
  return result;
}

}  // namespace

ErrorStatistics statistics_of(std::vector<double> errors) {
  ErrorStatistics s;
  if (errors.empty()) return s;
  std::sort(errors.begin(), errors.end());
  const auto n = static_cast<double>(errors.size());
  const std::size_t half = errors.size() / 2;
  s.count = static_cast<int>(errors.size());
  s.min = errors.front(), s.max = errors.back();
  s.median = errors.size() % 2 == 1 ? errors[half] : 0.5 * (errors[half - 1] + errors[half]);
  const auto quantile = [&errors, n](double share) {
    const double at = share * (n - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, errors.size() - 1);
    return errors[below] + (at - static_cast<double>(below)) * (errors[above] - errors[below]);
  };
  s.lower_quartile = quantile(0.25), s.upper_quartile = quantile(0.75);
  s.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
  double squares = 0.0, deviations = 0.0;
  for (const double error : errors) {
    squares += error * error;
    deviations += (error - s.mean) * (error - s.mean);
  }
  s.rmse = std::sqrt(squares / n);
  s.stddev = std::sqrt(deviations / n);
  return s;
}

std::vector<MatchedPose> match_trajectories(const Trajectory& truth, const Trajectory& estimate,
                                            double max_difference_s) {
  const auto stamps = [](const Trajectory& trajectory) {
    return column(trajectory, &StampedPose::timestamp);
  };
  std::vector<MatchedPose> matched;
  const auto pairs = associate(stamps(estimate), stamps(truth), max_difference_s);
  matched.reserve(pairs.size());  // of a long run the most that is held of a pose
  for (const AssociatedPair& pair : pairs) {
    const StampedPose &e = estimate[pair.first], &t = truth[pair.second];
    matched.push_back({e.timestamp, t.timestamp, e.world_from_camera, t.world_from_camera});
  }
  return matched;
}

std::vector<MatchedPose> match_nearest(const Trajectory& truth, const Trajectory& estimate,
                                       double max_difference_s) {
  const bool from_truth = truth.size() < estimate.size();
  const Trajectory &shorter = from_truth ? truth : estimate, &longer = from_truth ? estimate : truth;
  std::vector<MatchedPose> matched;
  if (longer.empty()) return matched;
  for (const StampedPose& pose : shorter) {
    // The first of the nearest, as an argument of the minimum is.
    const auto apart = [&pose](const StampedPose& other) {
      return std::abs(other.timestamp - pose.timestamp);
    };
    const auto nearest = std::min_element(longer.begin(), longer.end(),
                                          [&](const auto& a, const auto& b) { return apart(a) < apart(b); });
    if (apart(*nearest) > max_difference_s) continue;
    const StampedPose &e = from_truth ? *nearest : pose, &t = from_truth ? pose : *nearest;
    matched.push_back({e.timestamp, t.timestamp, e.world_from_camera, t.world_from_camera});
  }
  return matched;
}

std::vector<MatchedPose> match_interpolated(const Trajectory& truth, const Trajectory& estimate,
                                            double max_gap_s) {
  std::vector<MatchedPose> matched;
  for (const StampedPose& e : estimate)
    if (const auto there = interpolate(truth, e.timestamp, max_gap_s))
      matched.push_back({e.timestamp, e.timestamp, e.world_from_camera, *there});
  return matched;
}

AbsoluteTrajectoryError absolute_error(const std::vector<MatchedPose>& matched, AlignBy by, int align_first) {
  AbsoluteTrajectoryError result;
  const bool fitted = by != AlignBy::nothing && by != AlignBy::origin;
  const std::size_t needed = fitted ? kFewestToAlign : 1;
  std::size_t count = matched.size();  // poses to align by
  if (by == AlignBy::first) count = std::min(count, static_cast<std::size_t>(std::max(align_first, 0)));
  const Alignment aligned_by_all = align(
      count, [&matched](std::size_t i) -> const Pose& { return matched[i].estimate; },
      [&matched](std::size_t i) -> const Pose& { return matched[i].truth; });
  if (by == AlignBy::origin && !matched.empty())
    result.alignment.truth_from_estimate = matched.front().truth * matched.front().estimate.inverse();
  else if (fitted)
    result.alignment = aligned_by_all;
  result.errors.reserve(matched.size());
  for (const MatchedPose& pose : matched) {
    const Pose aligned = result.alignment.truth_from_estimate * pose.estimate;
    result.errors.push_back({pose.timestamp, (aligned.translation() - pose.truth.translation()).norm(),
                             to_degrees(rotation_angle(pose.truth.linear().transpose() * aligned.linear()))});
  }
  if (count < needed) {
    result.why_none = fmt::format("{}, and an alignment needs {}", counted(count, "matched pose"), needed);
    return result;
  }
  result.translation_m = statistics_of(column(result.errors, &AbsoluteError::translation_m));
  result.rotation_deg = statistics_of(column(result.errors, &AbsoluteError::rotation_deg));
  if (!aligned_by_all.degenerate) result.similarity = similarity_fit(matched);
  return result;
}

namespace {

RelativePoseError relative_error_over(const std::vector<MatchedPose>& matched, const RpeDelta& delta,
                                      const EvaluationOptions& options) {
  switch (delta.unit) {
    case RpeDelta::Unit::frames:
      return relative_error_over_frames(matched, static_cast<int>(delta.value));
    case RpeDelta::Unit::metres:
      return relative_error_over_distance(matched, delta.value);
    case RpeDelta::Unit::seconds:
      break;
  }
  return relative_error_over_time(matched, delta.value, options.delta_tolerance_s);
}

}  // namespace

TrajectoryEvaluation evaluate_trajectory(const Trajectory& truth, const Trajectory& estimate,
                                         const EvaluationOptions& options) {
  TrajectoryEvaluation result;
  result.truth_poses = static_cast<int>(truth.size());
  result.estimated_poses = static_cast<int>(estimate.size());
  result.expected_frames = options.expected_frames;
  if (options.expected_frames > 0)
    result.coverage = std::min(1.0, static_cast<double>(estimate.size()) / options.expected_frames);
  result.matched = options.interpolate_truth
                       ? match_interpolated(truth, estimate, options.interpolation_gap_s)
                   : options.nearest ? match_nearest(truth, estimate, options.max_difference_s)
                                     : match_trajectories(truth, estimate, options.max_difference_s);
  if (!truth.empty()) result.truth_span_s = truth.back().timestamp - truth.front().timestamp;
  if (!result.matched.empty())
    result.matched_span_s = result.matched.back().timestamp - result.matched.front().timestamp;
  if (options.align == AlignBy::similarity && result.matched.size() >= kFewestToAlign)
    if (const auto fit = similarity_fit(result.matched)) {
      result.applied_scale = fit->scale;
      for (MatchedPose& pose : result.matched) pose.estimate.translation() *= fit->scale;
    }
  result.ate = absolute_error(result.matched, options.align, options.align_first);
  result.rpe_time = relative_error_over_time(result.matched, options.delta_s, options.delta_tolerance_s);
  result.rpe_frame = relative_error_per_frame(result.matched, options.neighbour_gap);
  if (options.protocol == Protocol::tum)
    result.rpe_more.push_back(relative_error_of_random_pairs(truth, estimate));
  for (const RpeDelta& delta : options.deltas)
    result.rpe_more.push_back(relative_error_over(result.matched, delta, options));
  for (const double length : options.lengths_m)
    result.by_length.push_back(relative_error_over_distance(result.matched, length));
  return result;
}

std::string figure_text(const ErrorStatistics& statistics, int digits) {
  return statistics.count > 0 ? fmt::format("{:.{}f}", statistics.rmse, digits) : "–";
}

}  // namespace stillpoint
