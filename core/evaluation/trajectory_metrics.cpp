#include "core/evaluation/trajectory_metrics.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace stillpoint {
namespace {

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

template <typename Error>
std::vector<double> column(const std::vector<Error>& errors, double Error::*member) {
  std::vector<double> values;
  values.reserve(errors.size());
  for (const Error& error : errors) values.push_back(error.*member);
  return values;
}

template <typename Result, typename Error>
void summarise(Result& result, const std::vector<Error>& errors) {
  result.translation_m = statistics_of(column(errors, &Error::translation_m));
  result.rotation_deg = statistics_of(column(errors, &Error::rotation_deg));
}

RelativeError relative_error(const MatchedPose& i, const MatchedPose& j) {
  const Pose truth_motion = i.truth.inverse() * j.truth;
  const Pose estimated_motion = i.estimate.inverse() * j.estimate;
  const Pose error = truth_motion.inverse() * estimated_motion;
  return {i.timestamp, j.timestamp, error.translation().norm(), degrees(rotation_angle(error.linear()))};
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
  const Eigen::Matrix4d fit = Eigen::umeyama(from, to, true);
  SimilarityFit result;
  result.scale = std::cbrt(fit.topLeftCorner<3, 3>().determinant());
  if (!std::isfinite(result.scale) || result.scale <= 0) return std::nullopt;
  const Eigen::Matrix3Xd left =
      ((fit.topLeftCorner<3, 3>() * from).colwise() + fit.topRightCorner<3, 1>()) - to;
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
  for (const AssociatedPair& pair : associate(stamps(estimate), stamps(truth), max_difference_s)) {
    const StampedPose &e = estimate[pair.first], &t = truth[pair.second];
    matched.push_back({e.timestamp, t.timestamp, e.world_from_camera, t.world_from_camera});
  }
  return matched;
}

AbsoluteTrajectoryError absolute_error(const std::vector<MatchedPose>& matched) {
  std::vector<Pose> estimate, truth;
  for (const MatchedPose& pose : matched) {
    estimate.push_back(pose.estimate);
    truth.push_back(pose.truth);
  }
  AbsoluteTrajectoryError result;
  result.alignment = align(estimate, truth);
  for (const MatchedPose& pose : matched) {
    const Pose aligned = result.alignment.truth_from_estimate * pose.estimate;
    result.errors.push_back({pose.timestamp, (aligned.translation() - pose.truth.translation()).norm(),
                             degrees(rotation_angle(pose.truth.linear().transpose() * aligned.linear()))});
  }
  if (matched.size() < kFewestToAlign) {
    result.why_none =
        fmt::format("{} matched pose(s), and an alignment needs {}", matched.size(), kFewestToAlign);
    return result;
  }
  summarise(result, result.errors);
  if (!result.alignment.degenerate) result.similarity = similarity_fit(matched);
  return result;
}

RelativePoseError relative_error_over_time(const std::vector<MatchedPose>& matched, double delta_s,
                                           double tolerance_s) {
  RelativePoseError result;
  result.delta = fmt::format("{} s", delta_s);
  result.limit_s = tolerance_s;
  for (std::size_t i = 0; i < matched.size(); ++i) {
    const double wanted = matched[i].timestamp + delta_s;
    auto j = std::lower_bound(matched.begin(), matched.end(), wanted,
                              [](const MatchedPose& pose, double t) { return pose.timestamp < t; });
    if (j == matched.end() || (j != matched.begin() && wanted - (j - 1)->timestamp <= j->timestamp - wanted))
      --j;
    if (j - matched.begin() <= static_cast<std::ptrdiff_t>(i) ||
        std::abs(j->timestamp - wanted) > tolerance_s)
      ++result.dropped;
    else
      result.errors.push_back(relative_error(matched[i], *j));
  }
  summarise(result, result.errors);
  if (result.errors.empty()) result.why_none = fmt::format("no two matched poses are {} apart", result.delta);
  return result;
}

RelativePoseError relative_error_per_frame(const std::vector<MatchedPose>& matched, double neighbour_gap) {
  RelativePoseError result;
  result.delta = "1 frame";
  std::vector<double> gaps;
  for (std::size_t i = 0; i + 1 < matched.size(); ++i)
    gaps.push_back(matched[i + 1].timestamp - matched[i].timestamp);
  result.limit_s = neighbour_gap * statistics_of(gaps).median;
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    if (gaps[i] > result.limit_s)
      ++result.dropped;
    else
      result.errors.push_back(relative_error(matched[i], matched[i + 1]));
  }
  summarise(result, result.errors);
  if (result.errors.empty()) result.why_none = "no two matched poses follow one another";
  return result;
}

TrajectoryEvaluation evaluate_trajectory(const Trajectory& truth, const Trajectory& estimate,
                                         const EvaluationOptions& options) {
  TrajectoryEvaluation result;
  result.truth_poses = static_cast<int>(truth.size());
  result.estimated_poses = static_cast<int>(estimate.size());
  result.expected_frames = options.expected_frames;
  if (options.expected_frames > 0)
    result.coverage = std::min(1.0, static_cast<double>(estimate.size()) / options.expected_frames);
  result.matched = match_trajectories(truth, estimate, options.max_difference_s);
  if (!truth.empty()) result.truth_span_s = truth.back().timestamp - truth.front().timestamp;
  if (!result.matched.empty())
    result.matched_span_s = result.matched.back().timestamp - result.matched.front().timestamp;
  if (options.with_scale && result.matched.size() >= kFewestToAlign)
    if (const auto fit = similarity_fit(result.matched)) {
      result.applied_scale = fit->scale;
      for (MatchedPose& pose : result.matched) pose.estimate.translation() *= fit->scale;
    }
  result.ate = absolute_error(result.matched);
  result.rpe_time = relative_error_over_time(result.matched, options.delta_s, options.delta_tolerance_s);
  result.rpe_frame = relative_error_per_frame(result.matched, options.neighbour_gap);
  return result;
}

std::string figure_text(const ErrorStatistics& statistics, int digits) {
  return statistics.count > 0 ? fmt::format("{:.{}f}", statistics.rmse, digits) : "–";
}

std::string to_text(const TrajectoryEvaluation& e, const EvaluationOptions& options) {
  std::string text =
      fmt::format("Matched   {} of {} estimated poses, to {} of ground truth: one to one, closer than {} s\n",
                  e.matched.size(), e.estimated_poses, e.truth_poses, options.max_difference_s);
  text += e.coverage ? fmt::format("Coverage  {:.1f} %: {} poses for {} frames\n", 100.0 * *e.coverage,
                                   e.estimated_poses, e.expected_frames)
                     : "Coverage  not known without the number of frames (--frames, --sequence)\n";
  if (e.truth_span_s > 0)
    text += fmt::format("Time      matched poses span {:.3f} s of the truth's {:.3f} s ({:.1f} %)\n",
                        e.matched_span_s, e.truth_span_s, 100.0 * e.matched_span_s / e.truth_span_s);
  const char* how = options.with_scale ? "with scale (Sim(3))" : "rigidly, without scale";
  text += fmt::format(
      "Aligned   {}{}\n", how,
      e.ate.alignment.degenerate ? "; positions on a line or too few, so by orientations too" : "");
  if (options.with_scale)
    text += fmt::format("Scale     the estimate's lengths were multiplied by {:.4f}\n", e.applied_scale);
  else if (e.ate.similarity)
    text += fmt::format(
        "Scale     {:.4f} would fit best, and leave an ATE of {:.5f} m (--scale aligns with it)\n",
        e.ate.similarity->scale, e.ate.similarity->rmse_m);
  text += fmt::format("\n{:<24}{:<5}{:>7}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "", "unit", "pairs", "RMSE",
                      "mean", "median", "std", "min", "max");
  const auto row = [&](const std::string& name, const char* unit, const ErrorStatistics& s,
                       const std::string& why) {
    if (s.count == 0) {
      text += fmt::format("{:<24}{:<5}{:>7}{:>10}  {}\n", name, unit, s.count, "–", why);
      return;
    }
    text += fmt::format("{:<24}{:<5}{:>7}{:>10.5f}{:>10.5f}{:>10.5f}{:>10.5f}{:>10.5f}{:>10.5f}\n", name,
                        unit, s.count, s.rmse, s.mean, s.median, s.stddev, s.min, s.max);
  };
  row("ATE translation", "m", e.ate.translation_m, e.ate.why_none);
  row("ATE rotation", "deg", e.ate.rotation_deg, e.ate.why_none);
  for (const RelativePoseError* rpe : {&e.rpe_time, &e.rpe_frame}) {
    row(fmt::format("RPE {} translation", rpe->delta), "m", rpe->translation_m, rpe->why_none);
    row(fmt::format("RPE {} rotation", rpe->delta), "deg", rpe->rotation_deg, rpe->why_none);
  }
  text += fmt::format(
      "\nRPE {}: each matched pose with the one nearest {} later; {} without one within {} s dropped\n"
      "RPE {}: each matched pose with the next; {} gaps above {:.3f} s ({} times the median) dropped\n",
      e.rpe_time.delta, e.rpe_time.delta, e.rpe_time.dropped, e.rpe_time.limit_s, e.rpe_frame.delta,
      e.rpe_frame.dropped, e.rpe_frame.limit_s, options.neighbour_gap);
  return text;
}

}  // namespace stillpoint
