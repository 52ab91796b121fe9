#pragma once

#include <optional>
#include <vector>

#include "ui/plot/plot.hpp"

namespace stillpoint {

struct RelativePoseError;
struct RunView;
struct SessionView;

// What plots over a run are made of. Times are seconds since the run's first frame.

/// A curve's values, which plots only point at.
struct Series {
  std::vector<double> x, y;
};

/// s; what times of a session are counted from.
[[nodiscard]] double series_start(const SessionView& session);

/// Errors at the end of their motions, in mm or degrees; a gap (NaN) where motions are missing between.
[[nodiscard]] Series error_series(const RelativePoseError& error, double start, bool rotation);

/// From the first record's time to the last one's.
[[nodiscard]] AxisRange record_range(const SessionView& session);

/// The stretches of time in which the run had no pose.
[[nodiscard]] std::vector<PlotBand> lost_bands(const SessionView& session, Rgb colour);

/// The place of a frame's record among the run's; nothing where it has none.
[[nodiscard]] std::optional<std::size_t> record_of(const SessionView& session, int frame_index);

[[nodiscard]] std::optional<std::size_t> record_of(const RunView& run, int frame_index);

/// The index of the frame nearest to a time; nothing where there are no records.
[[nodiscard]] std::optional<int> frame_at(const SessionView& session, double seconds);

}  // namespace stillpoint
