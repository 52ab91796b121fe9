#pragma once

#include <string>
#include <vector>

namespace stillpoint {

struct RemovalError;

// Did removal help? The figures behind the answer. No ImGui.

struct RemovalSummary {
  int compared = 0;                 ///< frames solved both with and without removal
  int helped = 0, hurt = 0;         ///< … in which it mattered by more than the noise of such steps
  int beat_oracle = 0, oracle = 0;  ///< frames solved with the true mask too, and those removal did better in
  double median_with_m = 0.0;       ///< of the frames compared
  double median_without_m = 0.0;    ///< of the same
  double median_oracle_m = 0.0;     ///< of those
  double median_widened = 0.0;      ///< position sigma, as many times as with nothing removed; 0 = not known
  double greatest_gain_m = 0.0;     ///< by how much it helped most; 0 = never
  double greatest_harm_m = 0.0;     ///< by how much it hurt most
  int best_frame = -1, worst_frame = -1;  ///< where that was; -1 = nowhere
};

[[nodiscard]] RemovalSummary summarise(const std::vector<RemovalError>& errors);

/// "Removal helped in 34 of 100 frames, hurt in 3, and made no odds in 63."
[[nodiscard]] std::string sentence_of(const RemovalSummary& summary);

/// Frames in which removal hurt, the worst first.
[[nodiscard]] std::vector<int> by_harm(const std::vector<RemovalError>& errors);

}  // namespace stillpoint
