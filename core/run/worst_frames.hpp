#pragma once

#include <string>
#include <vector>

#include "core/run/frame_figures.hpp"

namespace stillpoint {

/// A frame to look at first, and why.
struct WorstFrame {
  int index = 0;
  std::string why;  ///< "lost: too few inliers", "step error 12.30 mm", …
};

/// The figure that failures show in first, an index into frame_figure_infos(): the step error where there is
/// ground truth, else inliers.
[[nodiscard]] int usual_figure(const MeasuredFrames& frames);

/// Frames worth looking at, worst first: the first of each stretch without a pose, in order of time, then
/// those with the worst values, each at least `apart` frames from those before it, so that one failure is
/// named once. The better half of the frames holds no failures, though nothing near some frame may be worse.
/// @param figure index into frame_figure_infos(); one of which low values are the bad ones is ranked from
/// below
[[nodiscard]] std::vector<WorstFrame> worst_frames(const MeasuredFrames& frames, int figure, int apart = 8,
                                                   std::size_t most = 50);

}  // namespace stillpoint
