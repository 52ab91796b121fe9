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

/// All that is known of one frame of a run.
struct MeasuredFrame {
  const FrameRecord& record;
  const FrameScores& scores;
  const TrajectoryEvaluation* evaluation = nullptr;  ///< null where there is no ground truth
  const RemovalError* removal = nullptr;             ///< null where the frame was not checked
};

/// A figure and where it comes from.
struct FrameFigure {
  FigureInfo info;
  double (*of)(const MeasuredFrame&) = nullptr;  ///< null: a method's own, found by its name. Of removal and
                                                 ///< evaluation it asks no more of a record than its outline
  bool of_removal = false;                       ///< known of frames that were checked alone
  bool of_evaluation = false;  ///< by MeasuredFrame::evaluation, which all frames together make
};

/// Every figure there is, each once: those of any run, then those that only one method measures.
[[nodiscard]] const std::vector<FrameFigure>& figure_table();

}  // namespace stillpoint
