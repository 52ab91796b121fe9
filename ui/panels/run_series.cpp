#include "ui/panels/run_series.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/median.hpp"
#include "core/odometry/frame_record.hpp"
#include "ui/session/session_view.hpp"

namespace stillpoint {

double series_start(const SessionView& session) {
  const FrameOutlines& frames = session.run->records.outlines();
  return frames.empty() ? session.current->frame.timestamp : frames.front().timestamp;
}

Series error_series(const RelativePoseError& error, double start, bool rotation) {
  Series series;
  std::vector<double> steps;
  for (std::size_t i = 1; i < error.errors.size(); ++i)
    steps.push_back(error.errors[i].to_timestamp - error.errors[i - 1].to_timestamp);
  double usual = std::numeric_limits<double>::infinity();
  if (!steps.empty()) usual = median_of(steps);
  for (const RelativeError& one : error.errors) {
    const double x = one.to_timestamp - start;
    // Two motions may end at one pose, and their order there is of no account; a plot's x must not decrease.
    if (!series.x.empty() && x < series.x.back()) continue;
    if (!series.x.empty() && x - series.x.back() > 4.0 * usual) {
      series.x.push_back(0.5 * (x + series.x.back()));
      series.y.push_back(std::nan(""));
    }
    series.x.push_back(x);
    series.y.push_back(rotation ? one.rotation_deg : 1000.0 * one.translation_m);
  }
  return series;
}

AxisRange record_range(const SessionView& session) {
  const FrameOutlines& frames = session.run->records.outlines();
  if (frames.size() < 2) return {0.0, 1.0};
  return {0.0, frames.back().timestamp - frames.front().timestamp};
}

std::vector<PlotBand> lost_bands(const SessionView& session, Rgb colour) {
  const FrameOutlines& frames = session.run->records.outlines();
  const double start = series_start(session);
  std::vector<PlotBand> bands;
  std::optional<double> from;
  for (const FrameOutline& frame : frames) {
    const double here = frame.timestamp - start;
    if (is_lost(frame.status)) {
      if (!from) from = here;
    } else if (from) {
      bands.push_back({{*from, here}, colour});
      from.reset();
    }
  }
  if (from) bands.push_back({{*from, frames.back().timestamp - start}, colour});
  return bands;
}

std::optional<std::size_t> record_of(const SessionView& session, int frame_index) {
  return record_of(*session.run, frame_index);
}

std::optional<std::size_t> record_of(const RunView& run, int frame_index) {
  const FrameOutlines& frames = run.records.outlines();
  const auto found =
      std::lower_bound(frames.begin(), frames.end(), frame_index,
                       [](const FrameOutline& frame, int index) { return frame.index < index; });
  if (found == frames.end() || found->index != frame_index) return std::nullopt;
  return static_cast<std::size_t>(found - frames.begin());
}

std::optional<int> frame_at(const SessionView& session, double seconds) {
  const FrameOutlines& frames = session.run->records.outlines();
  if (frames.empty()) return std::nullopt;
  const double time = seconds + series_start(session);
  const auto after =
      std::lower_bound(frames.begin(), frames.end(), time,
                       [](const FrameOutline& frame, double t) { return frame.timestamp < t; });
  if (after == frames.end()) return frames.back().index;
  if (after == frames.begin()) return after->index;
  const auto before = after - 1;
  return time - before->timestamp < after->timestamp - time ? before->index : after->index;
}

}  // namespace stillpoint
