#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/inspect/frame_view.hpp"

namespace stillpoint {

// What can be told of each frame in one number: lanes of the timeline, and what "worst" goes by.

enum class LaneFigure {
  kRpeFrame,
  kError,
  kMask,
  kInliers,
  kKept,
  kRemoved,
  kResidual,
  kTotalMs,
  kMotionMs,
  kFeaturesMs,
  kMatchingMs,
  kPoseMs,
  kMappingMs,
  kBundleMs,
  kCount
};

struct LaneInfo {
  LaneFigure figure;
  std::string_view key;   ///< "rpe"
  std::string_view name;  ///< "Step error"
  std::string_view unit;  ///< "mm"; empty for counts
  std::string_view help;  ///< one sentence
  bool low_is_bad = false;
};

/// All of them, in the order they are offered.
[[nodiscard]] std::span<const LaneInfo> lane_infos();
[[nodiscard]] const LaneInfo& info_of(LaneFigure figure);

/// One value a record, in the figure's unit; NaN where a frame has none.
[[nodiscard]] std::vector<double> lane_values(const RunView& run, LaneFigure figure);

/// The figure failures show in first: the step error where there is a truth, else inliers.
[[nodiscard]] LaneFigure usual_figure(const RunView& run);

/// Frames worth looking at, worst first: the first of each stretch without a pose, in order of time, then
/// those with the worst values, each at least `apart` frames from those before it, so that one failure is
/// named once.
[[nodiscard]] std::vector<int> worst_frames(const RunView& run, LaneFigure figure, int apart = 8,
                                            std::size_t most = 50);

}  // namespace stillpoint
