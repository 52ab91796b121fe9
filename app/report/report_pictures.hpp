#pragma once

#include <functional>
#include <memory>
#include <string>

#include "app/painter.hpp"
#include "app/report/report_run.hpp"
#include "core/run/worst_frames.hpp"
#include "ui/panels/run_look.hpp"
#include "ui/session/session.hpp"

namespace stillpoint {

/// What is told of each frame that is processed again for a picture: "walking_xyz (stillpoint)", its status.
using ReportProgress = std::function<void(const std::string& what)>;

/// How a run looks in every plot: as in the panels where its method has a role there, else as a ghost does.
/// @param place among its group's runs
[[nodiscard]] RunLook look_of_run(const ReportRun& run, std::size_t place, ThemeName theme);

/// Frames between two of a run's worst, at least: each is to be a failure of its own.
inline constexpr int kWorstApart = 10;

/// A run's frames to look at first, worst first, kWorstApart from each other.
[[nodiscard]] std::vector<WorstFrame> worst_frames_of(const ReportRun& run, int count);

/// Where in the page a run's frame is shown, among its worst.
[[nodiscard]] std::string frame_anchor(const ReportGroup& group, const ReportRun& run, int frame);

/// A session on a finished run, its group's baseline beside it.
/// @param catch_up frames are processed again as far as the one shown
[[nodiscard]] std::unique_ptr<Session> session_of_report(const ReportGroup& group, const ReportRun& run,
                                                         bool catch_up);

// The parts of a report that are pictures: HTML with the pictures in it.

/// The errors of all runs of a sequence over time, in the same axes.
[[nodiscard]] std::string error_plots(Painter& painter, const ReportGroup& group);

/// Where each run went, beside the truth and the baseline.
[[nodiscard]] std::string trajectories(Painter& painter, const ReportGroup& group);

/// The worst frames of a run with their panels. Frames of method `stillpoint` are processed again as far as
/// the last of them, for the stages that records do not hold.
/// @param link what a frame's name leads to, an address that `{}` has the frame's index in; empty = nothing
[[nodiscard]] std::string worst_frame_panels(Painter& painter, const ReportGroup& group, const ReportRun& run,
                                             int count, const std::string& link,
                                             const ReportProgress& progress);

}  // namespace stillpoint
