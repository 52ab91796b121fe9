#pragma once

#include <string>
#include <vector>

#include "ui/plot/plot.hpp"

namespace stillpoint {

/// The ranges of a plot's axes as it is looked at.
struct PlotAxes {
  AxisRange x, y;
  AxisScale y_scale = AxisScale::kLinear;
};

[[nodiscard]] PlotAxes axes_of(const Plot& plot, const PlotView& view);

/// A plot that outlives the frame it was drawn in: its values are its own.
class PlotFigure {
 public:
  PlotFigure(const Plot& plot, const PlotView& view);

  [[nodiscard]] const Plot& plot() const { return plot_; }
  [[nodiscard]] const PlotAxes& axes() const { return axes_; }

 private:
  std::vector<std::vector<double>> values_;  // x and y of each series, in turn; its spans refer to them
  Plot plot_;
  PlotAxes axes_;
};

/// Endings that write_plot() knows, for people: ".svg, .pdf, .png or .csv".
inline constexpr const char* kPlotEndings = ".svg, .pdf, .png or .csv";

/// All values of a plot as CSV, a row each of series, x and y; values that are not known are empty.
[[nodiscard]] std::string plot_values(const PlotFigure& figure);

/// The bytes of a plot as a file of an ending holds it: ".svg", ".pdf" or ".png", for print, on white.
[[nodiscard]] std::string plot_drawn(const PlotFigure& figure, const std::string& ending);

/// Writes a plot by its file's ending: .svg, .pdf and .png for print, on white, at the ranges it is looked
/// at; .csv its plot_values(). The same plot gives the same bytes.
/// @throws InputError for another ending, and where it cannot be written
void write_plot(const PlotFigure& figure, const std::string& path);

}  // namespace stillpoint
