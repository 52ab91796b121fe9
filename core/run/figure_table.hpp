#pragma once

#include <limits>
#include <vector>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/motion/methods.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/removal_errors.hpp"

namespace stillpoint {

/// What a figure is where it is not known.
inline constexpr double kUnknownFigure = std::numeric_limits<double>::quiet_NaN();

/// What a run leaves behind of one frame.
struct MeasuredFrame {
  const FrameRecord& record;
  const FrameScores& scores;
};

/// A figure and where it comes from: one of three, or by its name among those that a method measured
/// (FrameRecord::motion_figures). Each tells kUnknownFigure where it is not known.
struct FrameFigure {
  FigureInfo info;
  double (*of_frame)(const MeasuredFrame&) = nullptr;
  /// By the errors of all poses: of its frame it asks no more than the outline, so that records that are put
  /// by stay there.
  double (*of_evaluation)(const FrameOutline&, const TrajectoryEvaluation&) = nullptr;
  double (*of_removal)(const RemovalError&) = nullptr;  ///< of frames that were checked alone

  [[nodiscard]] bool is_of_method() const { return !of_frame && !of_evaluation && !of_removal; }
  [[nodiscard]] bool is_of_errors() const { return of_evaluation || of_removal; }
};

/// Every figure there is, each once: those of any run, then those that only one method measures.
[[nodiscard]] const std::vector<FrameFigure>& figure_table();

}  // namespace stillpoint
