#pragma once

#include <string>
#include <vector>

#include "ui/plot/plot.hpp"

namespace stillpoint {

/// The drawing half of draw_plot: axes mapped to the display, and a brush for each part of a plot.
class PlotPaint {
 public:
  explicit PlotPaint(const UiFrame& frame) : frame_(frame), list_(*ImGui::GetWindowDrawList()) {}

  AxisMap x, y;
  ImVec2 low, high;  ///< the area inside the axes, px of the display
  std::vector<AxisTick> x_ticks, y_ticks;

  [[nodiscard]] ImVec2 text_size(const std::string& text) const;

  void ground(const Plot& plot) const;
  void axes(const Plot& plot, ImVec2 outer_low, ImVec2 outer_high) const;
  void clip() const;
  void unclip() const;
  void band(const PlotBand& band) const;
  void series(const PlotSeries& series) const;
  void level(const PlotLevel& level) const;
  void mark(const PlotLevel& mark) const;
  void cursor(double at_x) const;
  /// The y axis's label and the legend, above the area.
  void heading(const Plot& plot, ImVec2 outer_low, ImVec2 outer_high) const;
  /// A hairline at the mouse, a dot on each curve and a box with the values.
  void hover(const Plot& plot, double at_x) const;

 private:
  [[nodiscard]] ImVec2 place(double value_x, double value_y) const;
  void text(ImVec2 at, const std::string& words, ImU32 colour) const;
  /// Text that reads on whatever is drawn there.
  void label(ImVec2 at, const std::string& words, Rgb colour) const;
  void line(const PlotSeries& series, const std::vector<PlotSample>& samples) const;
  /// A whole line, as wide at its sharpest turn as elsewhere.
  void joined(const std::vector<ImVec2>& run, ImU32 colour, float width) const;
  void dashed(ImVec2 from, ImVec2 to, ImU32 colour, float width, float& phase,
              SeriesStyle style = SeriesStyle::kDashed) const;
  void swatch(ImVec2 at, const PlotSeries& series) const;

  const UiFrame& frame_;
  ImDrawList& list_;
};

}  // namespace stillpoint
