#pragma once

#include <string>
#include <vector>

#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"

namespace stillpoint {

/// A frame to look at first, and why.
struct WorstFrame {
  int index = 0;
  std::string why;  ///< "lost: …", "moved 12.3 mm other than it did since the frame before", …
};

/// The frames in which a run did worst, worst first: where it got lost, each stretch once; then by the error
/// of the motion from the frame before, or, without ground truth, by how few inliers the pose rests on.
/// @param count at most so many, and no two of them closer together than `apart` frames
[[nodiscard]] std::vector<WorstFrame> worst_frames(const RunResult& run, const RunReport& report, int count,
                                                   int apart);

}  // namespace stillpoint
