#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace stillpoint {

/// How long the interface keeps a person waiting: from taking input to showing the frame drawn from it, wall
/// time. Sleeping between frames is not waiting.
struct UiPace {
  static constexpr double kLimitMs = 50.0;  ///< above it a person notices

  double last_ms = 0.0;
  double mean_ms = 0.0;  ///< of all frames drawn
  long frames = 0;

  // While frames of the sequence were being processed or opened.
  double longest_busy_ms = 0.0;
  long busy_frames = 0, busy_over_limit = 0;
  static constexpr double kBinMs = 0.5;  // ms: far below what is felt
  std::array<long, 400> busy_by_ms{};    ///< how many took so long, the last bin and longer

  /// ms: this share (0 to 1) of the frames drawn beside work took no longer, to half a
  /// millisecond; 0 where there were none.
  [[nodiscard]] double busy_within_ms(double share) const {
    long left = static_cast<long>(share * static_cast<double>(busy_frames));
    for (std::size_t bin = 0; bin < busy_by_ms.size(); ++bin)
      if ((left -= busy_by_ms[bin]) < 0) return kBinMs * static_cast<double>(bin + 1);
    return longest_busy_ms;
  }

  /// Adds a frame of the interface. @param busy whether work was going on beside it
  void add(double ms, bool busy) {
    last_ms = ms;
    ++frames;
    mean_ms += (ms - mean_ms) / static_cast<double>(frames);
    if (!busy) return;
    ++busy_frames;
    ++busy_by_ms[std::min(static_cast<std::size_t>(std::max(ms, 0.0) / kBinMs), busy_by_ms.size() - 1)];
    longest_busy_ms = std::max(longest_busy_ms, ms);
    if (ms > kLimitMs) ++busy_over_limit;
  }
};

}  // namespace stillpoint
