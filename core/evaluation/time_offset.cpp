#include "core/evaluation/time_offset.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/evaluation/trajectory_metrics.hpp"

namespace stillpoint {
namespace {

constexpr double kStep = 0.01;              // s, of the first search: well below a hand's period
constexpr double kReach = 0.5 + 2 * kStep;  // s, to both sides: the last step is not told
constexpr double kPrecision = 1e-8;         // s, at which the second one ends
constexpr double kLargestGap = 0.1;         // s, between neighbours of the truth
constexpr std::size_t kFewest = 10;         // poses: below, any offset fits some
constexpr double kProbe = 0.02;             // s off the best: there the error must have grown …
constexpr double kTelling = 1.01;           // … to so many times
constexpr double kApart = 0.03;             // s, for holds_without_any_part

double error_at(const Trajectory& truth, Trajectory shifted, double offset) {
  for (StampedPose& pose : shifted) pose.timestamp += offset;
  const auto matched = match_interpolated(truth, shifted, kLargestGap);
  if (2 * matched.size() < shifted.size()) return std::numeric_limits<double>::infinity();
  return absolute_error(matched).translation_m.rmse;
}

/// The best of the first search. Nothing where it is the last one on its side: beyond, it may be better
/// still.
std::optional<double> best_step(const Trajectory& truth, const Trajectory& estimate, double reach) {
  const int steps = static_cast<int>(std::floor(reach / kStep + 1e-9));
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = -steps; i <= steps; ++i)
    if (const double found = error_at(truth, estimate, i * kStep); found < least) least = found, best = i;
  if (!std::isfinite(least) || std::abs(best) == steps) return std::nullopt;
  return best * kStep;
}

}  // namespace

OffsetSearch offset_search(const Trajectory& truth, const Trajectory& estimate, double most_s) {
  OffsetSearch search;
  if (truth.empty()) return search;
  const auto room = [&truth](const StampedPose& pose) {
    return std::min(pose.timestamp - truth.front().timestamp, truth.back().timestamp - pose.timestamp);
  };
  std::vector<double> rooms;
  for (const StampedPose& pose : estimate)
    if (room(pose) >= 0) rooms.push_back(room(pose));
  if (rooms.empty()) return search;
  std::sort(rooms.begin(), rooms.end(), std::greater<>());
  search.reach_s = std::min(most_s, rooms[(2 * rooms.size() + 2) / 3 - 1]);
  for (std::size_t i = 0; i < estimate.size(); ++i)
    if (room(estimate[i]) >= search.reach_s) search.poses.push_back(i);
  return search;
}

bool holds_without_any_part(
    double offset_s, double apart_s, const std::vector<std::size_t>& samples,
    const std::function<std::optional<double>(const std::vector<std::size_t>&)>& find) {
  constexpr std::size_t kParts = 5;     // of the samples: four fifths still tell an offset
  constexpr double kApartShare = 0.25;  // of the offset
  for (std::size_t part = 0; part < kParts; ++part) {
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (i * kParts / samples.size() != part) kept.push_back(samples[i]);
    const auto told = find(kept);
    if (!told || std::abs(*told - offset_s) > apart_s + kApartShare * std::abs(offset_s)) return false;
  }
  return true;
}

std::optional<TimeOffset> estimate_time_offset(const Trajectory& truth, const Trajectory& estimate) {
  const OffsetSearch search = offset_search(truth, estimate, kReach);
  if (search.poses.size() < kFewest || 2 * search.poses.size() < estimate.size()) return std::nullopt;
  const auto those = [&estimate](const std::vector<std::size_t>& poses) {
    Trajectory chosen;
    for (const std::size_t i : poses) chosen.push_back(estimate[i]);
    return chosen;
  };
  const auto find = [&](const std::vector<std::size_t>& poses) {
    return best_step(truth, those(poses), search.reach_s);
  };
  const auto best = find(search.poses);
  if (!best || !holds_without_any_part(*best, kApart, search.poses, find)) return std::nullopt;
  const Trajectory measured = those(search.poses);
  const auto error = [&](double offset) { return error_at(truth, measured, offset); };
  // The golden section within the neighbouring steps.
  const double section = 0.5 * (std::sqrt(5.0) - 1.0);
  double low = *best - kStep, high = *best + kStep;
  while (high - low > kPrecision) {
    const double left = high - section * (high - low), right = low + section * (high - low);
    (error(left) < error(right) ? high : low) = error(left) < error(right) ? right : left;
  }
  TimeOffset result{0.5 * (low + high), error(0.0), 0.0};
  result.rmse_after_m = error(result.offset_s);
  const double beside = std::min(error(result.offset_s - kProbe), error(result.offset_s + kProbe));
  if (!std::isfinite(result.rmse_before_m) || beside <= kTelling * result.rmse_after_m) return std::nullopt;
  return result;
}

}  // namespace stillpoint
