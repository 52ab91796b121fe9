#pragma once

#include <optional>
#include <vector>

#include "core/run/frame_figures.hpp"

namespace stillpoint {

/// Two figures of the frames at which both are known, in order of the first.
struct FigurePairs {
  std::vector<double> x, y;  ///< in the figures' own units
  std::vector<int> frames;   ///< index of each frame
};

/// @param x,y indices into frame_figure_infos()
[[nodiscard]] FigurePairs figure_pairs(const MeasuredFrames& measured, int x, int y);

/// Spearman's rank correlation, -1 to 1: how far y grows as x does, whatever the shape. Equal values share
/// the mean of their ranks. Nothing for fewer than three pairs, and where one of the two never changes.
/// @pre x ascends
[[nodiscard]] std::optional<double> rank_correlation(const FigurePairs& pairs);

}  // namespace stillpoint
