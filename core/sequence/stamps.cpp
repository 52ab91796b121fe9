#include "core/sequence/stamps.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace stillpoint {
namespace {

constexpr double kMostFrames = 1e7;         // frame numbers stay below this: 90 hours at 30 Hz
constexpr double kFirstEpoch = 9e8;         // s since 1970: 1998, before which there is no such data …
constexpr double kLastEpoch = 4e9;          // … and 2096
constexpr double kLongestEpochStep = 10.0;  // s, median, of stamps that count from 1970
constexpr double kShortestMillisecondStep = 8.0;  // of whole numbers: a camera of 120 Hz
constexpr double kLongestFrameStep = 15.0;  // every so many frames kept; beyond, a step is rather a time

/// The unit in which stamps of this size and median step would be a time since 1970.
std::optional<StampUnit> epoch_unit(double largest, std::optional<double> step) {
  for (const StampUnit unit :
       {StampUnit::seconds, StampUnit::milliseconds, StampUnit::microseconds, StampUnit::nanoseconds}) {
    const double second = 1.0 / seconds_per(unit);
    if (largest < kFirstEpoch * second || largest > kLastEpoch * second) continue;
    if (!step || *step <= kLongestEpochStep * second) return unit;
  }
  return std::nullopt;
}

/// Whole numbers of no known origin: frames, or milliseconds.
StampUnit unit_of_whole(const std::vector<double>& steps, double median_step) {
  if (median_step < kShortestMillisecondStep) return StampUnit::frames;
  const double least = *std::min_element(steps.begin(), steps.end());
  const bool regular =
      std::all_of(steps.begin(), steps.end(), [&](double step) { return std::fmod(step, least) == 0.0; });
  return regular && least <= kLongestFrameStep ? StampUnit::frames : StampUnit::milliseconds;
}

bool are_whole(const std::vector<double>& stamps) {
  return std::all_of(stamps.begin(), stamps.end(), [](double t) { return t == std::floor(t) && t >= 0; });
}

}  // namespace

std::string_view to_string(StampUnit unit) {
  switch (unit) {
    case StampUnit::milliseconds:
      return "milliseconds";
    case StampUnit::microseconds:
      return "microseconds";
    case StampUnit::nanoseconds:
      return "nanoseconds";
    case StampUnit::frames:
      return "frame numbers";
    case StampUnit::seconds:
      break;
  }
  return "seconds";
}

double seconds_per(StampUnit unit, double frame_rate) {
  switch (unit) {
    case StampUnit::milliseconds:
      return 1e-3;
    case StampUnit::microseconds:
      return 1e-6;
    case StampUnit::nanoseconds:
      return 1e-9;
    case StampUnit::frames:
      return 1.0 / frame_rate;
    case StampUnit::seconds:
      break;
  }
  return 1.0;
}

StampUnit unit_of(std::vector<double> stamps) {
  if (stamps.empty()) return StampUnit::seconds;
  std::sort(stamps.begin(), stamps.end());
  const double largest = std::max(std::abs(stamps.front()), std::abs(stamps.back()));
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    if (stamps[i] > stamps[i - 1]) steps.push_back(stamps[i] - stamps[i - 1]);
  if (steps.empty()) return epoch_unit(largest, {}).value_or(StampUnit::seconds);
  std::vector<double> order = steps;
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2), order.end());
  const double step = order[order.size() / 2];
  if (const auto unit = epoch_unit(largest, step)) return *unit;
  if (step >= 2e6) return StampUnit::nanoseconds;
  if (step >= 2e3) return StampUnit::microseconds;
  if (are_whole(stamps) && largest < kMostFrames) return unit_of_whole(steps, step);
  return step >= 5.0 ? StampUnit::milliseconds : StampUnit::seconds;
}

int meetings(const std::vector<double>& stamps, const std::vector<double>& reference, double tolerance) {
  int count = 0;
  for (const double stamp : stamps) {
    const auto after = std::lower_bound(reference.begin(), reference.end(), stamp);
    const bool met = (after != reference.end() && *after - stamp < tolerance) ||
                     (after != reference.begin() && stamp - *(after - 1) < tolerance);
    count += met ? 1 : 0;
  }
  return count;
}

StampUnit unit_beside(const std::vector<double>& stamps, const std::vector<double>& reference_s,
                      StampUnit reference_unit, double frame_rate, double tolerance) {
  const bool whole = are_whole(stamps) && stamps.size() > 1 && stamps.back() < kMostFrames;
  const StampUnit own = unit_of(stamps);
  StampUnit best = own;
  int most = 0;
  // Any unit fits somewhere when its stamps are squeezed enough; so only those that are likely in themselves
  // count, and what whole numbers may be.
  std::vector<StampUnit> units = {reference_unit, own, StampUnit::seconds};
  if (whole) units.insert(units.end(), {StampUnit::milliseconds, StampUnit::frames});
  for (const StampUnit unit : units) {
    if (unit == StampUnit::frames && !whole) continue;
    std::vector<double> seconds = stamps;
    for (double& stamp : seconds) stamp *= seconds_per(unit, frame_rate);
    // Both ways: squeezed into a moment, all stamps would find that moment's reference.
    const int met =
        std::min(meetings(seconds, reference_s, tolerance), meetings(reference_s, seconds, tolerance));
    if (met > most) best = unit, most = met;
  }
  return best;
}

}  // namespace stillpoint
