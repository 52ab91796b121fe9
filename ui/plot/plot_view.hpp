#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "ui/plot/plot_axis.hpp"

namespace stillpoint {

/// How a plot is looked at: plain data, kept between frames and with the layout. Without ranges of its own a
/// plot shows everything.
struct PlotView {
  std::optional<AxisRange>
      x{};  ///< set by zooming and panning; shared by plots that are given the same PlotView
  std::optional<AxisRange> y{};
  bool log_y = false;
};

/// A sample of a decimated series.
struct PlotSample {
  double x = 0.0, y = 0.0;
};

/// A series as few points as a plot `columns` px wide can show, cut to `range`: per column first, least,
/// greatest and last, so that no spike is lost. Gaps (NaN) stay as one NaN. `x` must not decrease; sizes must
/// agree.
[[nodiscard]] std::vector<PlotSample> decimate(std::span<const double> x, std::span<const double> y,
                                               const AxisRange& range, int columns);

/// The index of the value nearest to `value`; x must not decrease. Nothing for an empty series.
[[nodiscard]] std::optional<std::size_t> nearest_index(std::span<const double> x, double value);

}  // namespace stillpoint
