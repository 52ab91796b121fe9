#pragma once

#include <imgui.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ui/plot/plot_view.hpp"
#include "ui/theme/palette.hpp"

namespace stillpoint {

struct UiFrame;

enum class SeriesStyle {
  kLine,     ///< values joined
  kDashed,   ///< values joined by dashes: told apart without colour
  kDotted,   ///< … by dots
  kDashDot,  ///< … by long dashes and dots
  kSteps,    ///< each value holds until the next
  kBars,     ///< bars from the lower edge: histograms
  kDots,     ///< values alone
};

/// One curve. Its values belong to the caller.
struct PlotSeries {
  std::string name;           ///< in the legend
  std::span<const double> x;  ///< must not decrease
  std::span<const double> y;  ///< NaN makes a gap
  Rgb colour;
  SeriesStyle style = SeriesStyle::kLine;
  float width_px = 1.6F;  ///< design px
};

/// A level to be compared with: a dashed line across, named.
struct PlotLevel {
  double value = 0.0;
  std::string name;
  Rgb colour;
};

/// A stretch of x to be seen behind the curves: lost frames, a selection.
struct PlotBand {
  AxisRange x;
  Rgb colour;
  float opacity = 0.15F;
};

/// A plot, described anew each frame.
struct Plot {
  std::string x_label{}, x_unit{};  ///< "time", "s"
  std::string y_label{}, y_unit{};  ///< "RPE", "m"
  std::vector<PlotSeries> series{};
  std::vector<PlotLevel> levels{};
  std::vector<PlotLevel> marks{};  ///< as levels, but upright: at an x
  std::vector<PlotBand> bands{};
  std::optional<double> cursor_x{};     ///< the current frame
  std::optional<AxisRange> x_limits{};  ///< what "everything" means in x; else the series' extent
  double x_step = 0.0;                  ///< labels of x are no closer: 1 where x is a frame
  bool y_from_zero = true;              ///< the y axis begins at zero when nothing is negative
  bool legend = true;
  bool equal_scale = false;  ///< in files: a unit of x is as long as one of y, and x may go back: paths
};

/// What the mouse did to a plot.
struct PlotResponse {
  std::optional<double> hovered_x;  ///< value under the mouse
  std::optional<double>
      clicked_x;  ///< pressed and released in place, or dragged along with the left button held
};

/// Draws a plot into the given size (0 takes what is left) at ImGui's cursor, and lets wheel (zoom x; Ctrl:
/// y), right or middle drag (pan) and double click (show all) change `view`.
PlotResponse draw_plot(const UiFrame& frame, const char* id, const Plot& plot, PlotView& view,
                       ImVec2 size = {0, 0});

}  // namespace stillpoint
