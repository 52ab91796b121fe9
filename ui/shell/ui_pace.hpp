#pragma once

#include <algorithm>

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

  /// Adds a frame of the interface. @param busy whether work was going on beside it
  void add(double ms, bool busy) {
    last_ms = ms;
    ++frames;
    mean_ms += (ms - mean_ms) / static_cast<double>(frames);
    if (!busy) return;
    ++busy_frames;
    longest_busy_ms = std::max(longest_busy_ms, ms);
    if (ms > kLimitMs) ++busy_over_limit;
  }
};

}  // namespace stillpoint
