#include "core/evaluation/time_offset.hpp"

#include <cmath>
#include <limits>

#include "core/evaluation/trajectory_metrics.hpp"

namespace stillpoint {
namespace {

constexpr double kReach = 0.5;       // s, to both sides
constexpr double kStep = 0.01;       // s, of the first search: well below a hand's period
constexpr double kPrecision = 1e-8;  // s, at which the second one ends
constexpr double kLargestGap = 0.1;  // s, between neighbours of the truth
constexpr std::size_t kFewest = 10;  // poses: below, any offset fits some
constexpr double kProbe = 0.02;      // s off the best: there the error must have grown …
constexpr double kTelling = 1.01;    // … to so many times

double error_at(const Trajectory& truth, Trajectory shifted, double offset) {
  for (StampedPose& pose : shifted) pose.timestamp += offset;
  const auto matched = match_interpolated(truth, shifted, kLargestGap);
  if (matched.size() < kFewest || 2 * matched.size() < shifted.size())
    return std::numeric_limits<double>::infinity();
  return absolute_error(matched).translation_m.rmse;
}

}  // namespace

std::optional<TimeOffset> estimate_time_offset(const Trajectory& truth, const Trajectory& estimate) {
  const auto error = [&](double offset) { return error_at(truth, estimate, offset); };
  double best = 0.0, least = std::numeric_limits<double>::infinity();
  const int steps = static_cast<int>(std::lround(kReach / kStep));
  for (int i = -steps; i <= steps; ++i)
    if (const double found = error(i * kStep); found < least) least = found, best = i * kStep;
  if (!std::isfinite(least)) return std::nullopt;
  // The golden section within the neighbouring steps.
  const double section = 0.5 * (std::sqrt(5.0) - 1.0);
  double low = best - kStep, high = best + kStep;
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
