#include "core/sequence/bag/bag_stamps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "core/counted.hpp"
#include "core/sequence/bag/frame_tree.hpp"

namespace stillpoint {
namespace {

constexpr std::int64_t kAtZero = 100'000'000;  // ns: a clock that begins at 0 may stamp its first message so
constexpr int kMostLate =
    8;  // changes from one stretch to the other: fewer are a few messages that came late

/// Puts messages without a stamp where their times of recording say. @return how many there were
std::size_t stamp_unstamped(std::vector<std::int64_t>& stamps, const std::vector<std::int64_t>& recorded) {
  std::vector<std::int64_t> late;
  for (std::size_t i = 0; i < stamps.size(); ++i)
    if (stamps[i] != 0) late.push_back(recorded[i] - stamps[i]);
  if (late.empty() || late.size() == stamps.size()) return 0;
  const auto middle = late.begin() + static_cast<std::ptrdiff_t>(late.size() / 2);
  std::nth_element(late.begin(), middle, late.end());
  std::size_t count = 0;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (stamps[i] != 0 || std::abs(recorded[i] - *middle) < kAtZero) continue;
    stamps[i] = recorded[i] - *middle;
    ++count;
  }
  return count;
}

/// The first message after the clock was set back, where it was, once.
std::optional<std::size_t> set_back_at(const std::vector<std::int64_t>& stamps) {
  const auto first = std::is_sorted_until(stamps.begin(), stamps.end());
  if (first == stamps.end() || !std::is_sorted(first, stamps.end())) return std::nullopt;
  int changes = 0;
  bool was_before = true;
  for (auto before = stamps.begin(), after = first; before != first && after != stamps.end();) {
    const bool is_before = *before <= *after;
    changes += is_before != was_before ? 1 : 0;
    was_before = is_before;
    ++(is_before ? before : after);
  }
  if (changes < kMostLate) return std::nullopt;
  return static_cast<std::size_t>(first - stamps.begin());
}

}  // namespace

BagStamps settle_bag_stamps(std::vector<std::int64_t> stamps, const std::vector<std::int64_t>& recorded) {
  BagStamps settled;
  const auto [least, most] = std::minmax_element(stamps.begin(), stamps.end());
  if (stamps.size() > 1 && *least == *most) {
    settled.told =
        fmt::format("all stamps are {:.3f} s; the times of recording were taken instead", seconds_of(*least));
    settled.stamps = recorded;
    return settled;
  }
  if (const std::size_t unstamped = stamp_unstamped(stamps, recorded); unstamped > 0)
    settled.told = fmt::format("{} of {} have the stamp 0; the times of recording were taken for these",
                               unstamped, counted(stamps.size(), "message"));
  if (const auto at = set_back_at(stamps)) {
    const double back_s =
        seconds_of(stamps[*at - 1] - stamps[*at]) + seconds_of(recorded[*at] - recorded[*at - 1]);
    settled.told = fmt::format(
        "the clock was set back by {:.3f} s before message {} of {}; the times of recording were taken "
        "instead",
        back_s, *at + 1, stamps.size());
    settled.stamps = recorded;
    return settled;
  }
  settled.stamps = std::move(stamps);
  return settled;
}

}  // namespace stillpoint
