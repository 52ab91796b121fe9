#pragma once

#include <functional>
#include <string>

#include "app/painter.hpp"
#include "app/report/report_run.hpp"

namespace stillpoint {

/// What is told of each frame that is processed again for a picture: "walking_xyz (stillpoint)", its status.
using ReportProgress = std::function<void(const std::string& what)>;

// The parts of a report that are pictures: HTML with the pictures in it.

/// The errors of all runs of a sequence over time, in the same axes.
[[nodiscard]] std::string error_plots(Painter& painter, const ReportGroup& group);

/// Where each run went, beside the truth and the baseline.
[[nodiscard]] std::string trajectories(Painter& painter, const ReportGroup& group);

/// The worst frames of a run with their panels. Frames of method `stillpoint` are processed again as far as
/// the last of them, for the stages that records do not hold.
[[nodiscard]] std::string worst_frame_panels(Painter& painter, const ReportGroup& group, const ReportRun& run,
                                             int count, const ReportProgress& progress);

}  // namespace stillpoint
