#include "core/run/removal_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/geometry/normal_equations.hpp"
#include "core/median.hpp"

namespace stillpoint {
namespace {

constexpr double kNoticeable = 1e-3;  // m: below, no step is called worse
constexpr double kSigmas = 3.0;       // standard deviations: beyond, chance seldom makes a step worse

double step_error(const Pose& true_step, const Pose& before, const std::optional<Pose>& now) {
  if (!now) return std::numeric_limits<double>::quiet_NaN();
  return (true_step.inverse() * (before.inverse() * *now)).translation().norm();
}

double widening(const FrameRecord& record) {
  const double kept = largest_deviation(record.pose_covariance.topLeftCorner<3, 3>()),
               all = record.removal_check.nothing_removed_sigma_m;
  return kept > 0 && all > 0 ? kept / all : std::numeric_limits<double>::quiet_NaN();
}

void judge(std::vector<RemovalError>& errors) {
  std::vector<double> differences;
  for (const RemovalError& error : errors)
    if (const double worse = error.with_removal_m - error.without_removal_m; !std::isnan(worse))
      differences.push_back(worse);
  const double middle = median_of(differences);
  for (double& difference : differences) difference = std::abs(difference - middle);
  const double noise = 1.4826 * median_of(differences);  // of normally distributed values, its sigma
  const double least = std::max(kNoticeable, kSigmas * noise);
  for (RemovalError& error : errors) {
    error.hurt = error.with_removal_m - error.without_removal_m > least;
    error.helped = error.without_removal_m - error.with_removal_m > least;
  }
}

}  // namespace

std::vector<RemovalError> removal_errors(const FrameRecords& records,
                                         const TrajectoryEvaluation& evaluation) {
  const FrameOutlines& outlines = records.outlines();
  if (std::none_of(outlines.begin(), outlines.end(),
                   [](const FrameOutline& one) { return one.removal_checked; }))
    return {};
  std::unordered_map<double, const Pose*> truth;
  for (const MatchedPose& matched : evaluation.matched) truth.emplace(matched.timestamp, &matched.truth);
  std::vector<RemovalError> errors;
  struct Before {
    double timestamp = 0.0;
    bool estimated = false;
    Pose world_from_camera = Pose::Identity();
  };
  std::optional<Before> last;
  for (const FrameRecord& now : records) {
    const std::optional<Before> here = Before{now.timestamp, now.estimated, now.world_from_camera};
    const std::optional<Before> kept = std::exchange(last, here);
    if (!kept) continue;
    const Before& before = *kept;
    const bool checked = now.removal_check.nothing_removed || now.removal_check.truth_removed;
    const auto true_before = truth.find(before.timestamp), true_now = truth.find(now.timestamp);
    if (!checked || !before.estimated || true_before == truth.end() || true_now == truth.end()) continue;
    const Pose true_step = true_before->second->inverse() * *true_now->second;
    const auto error = [&](const std::optional<Pose>& pose) {
      return step_error(true_step, before.world_from_camera, pose);
    };
    errors.push_back(
        {.frame = now.index,
         .with_removal_m = error(now.estimated ? std::optional(now.world_from_camera) : std::nullopt),
         .without_removal_m = error(now.removal_check.nothing_removed),
         .oracle_m = error(now.removal_check.truth_removed),
         .widened = widening(now),
         .hurt = false,
         .helped = false});
  }
  judge(errors);
  return errors;
}

}  // namespace stillpoint
