#include "core/evaluation/trajectory_metrics.hpp"

#include <fmt/format.h>

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
  summarise(result, result.errors);
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
  result.ate = absolute_error(result.matched);
  result.rpe_time = relative_error_over_time(result.matched, options.delta_s, options.delta_tolerance_s);
  result.rpe_frame = relative_error_per_frame(result.matched, options.neighbour_gap);
  return result;
}

std::string to_text(const TrajectoryEvaluation& e, const EvaluationOptions& options) {
  std::string text =
      fmt::format("Matched   {} of {} estimated poses, to {} of ground truth: one to one, closer than {} s\n",
                  e.matched.size(), e.estimated_poses, e.truth_poses, options.max_difference_s);
  text += e.coverage ? fmt::format("Coverage  {:.1f} %: {} poses for {} frames\n", 100.0 * *e.coverage,
                                   e.estimated_poses, e.expected_frames)
                     : "Coverage  not known without the number of frames\n";
  text += fmt::format(
      "Aligned   rigidly, without scale{}\n\n",
      e.ate.alignment.degenerate ? "; positions on a line or too few, so by orientations too" : "");
  text += fmt::format("{:<24}{:<5}{:>7}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "", "unit", "pairs", "RMSE",
                      "mean", "median", "std", "min", "max");
  const auto row = [&](const std::string& name, const char* unit, const ErrorStatistics& s) {
    text += fmt::format("{:<24}{:<5}{:>7}{:>10.5f}{:>10.5f}{:>10.5f}{:>10.5f}{:>10.5f}{:>10.5f}\n", name,
                        unit, s.count, s.rmse, s.mean, s.median, s.stddev, s.min, s.max);
  };
  row("ATE translation", "m", e.ate.translation_m);
  row("ATE rotation", "deg", e.ate.rotation_deg);
  for (const RelativePoseError* rpe : {&e.rpe_time, &e.rpe_frame}) {
    row(fmt::format("RPE {} translation", rpe->delta), "m", rpe->translation_m);
    row(fmt::format("RPE {} rotation", rpe->delta), "deg", rpe->rotation_deg);
  }
  text += fmt::format(
      "\nRPE {}: each matched pose with the one nearest {} later; {} without one within {} s dropped\n"
      "RPE {}: each matched pose with the next; {} gaps above {:.3f} s ({} times the median) dropped\n",
      e.rpe_time.delta, e.rpe_time.delta, e.rpe_time.dropped, e.rpe_time.limit_s, e.rpe_frame.delta,
      e.rpe_frame.dropped, e.rpe_frame.limit_s, options.neighbour_gap);
  return text;
}

}  // namespace stillpoint
