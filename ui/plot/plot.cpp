#include "ui/plot/plot.hpp"

#include <algorithm>
#include <cmath>

#include "ui/plot/plot_file.hpp"
#include "ui/plot/plot_paint.hpp"
#include "ui/plot/right_click.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/theme/fonts.hpp"

namespace stillpoint {
namespace {

constexpr double kMargin = 0.06;                               // of the values' extent, above and below
constexpr double kWheelFactor = 1.2;                           // times the range, a notch of the wheel
constexpr float kPixelsATickX = 90.0F, kPixelsATickY = 38.0F;  // design px: labels keep apart

/// All the values of y that lie in a stretch of x.
AxisRange y_extent(const Plot& plot, const AxisRange& x, AxisScale scale) {
  std::vector<double> seen;
  for (const PlotSeries& series : plot.series) {
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (series.x[i] >= x.low && series.x[i] <= x.high) seen.push_back(series.y[i]);
    }
  }
  const bool anything = std::any_of(seen.begin(), seen.end(), [](double y) { return std::isfinite(y); });
  // A level far above the values would press them flat, so it only counts while it is near.
  const AxisRange values = range_of(seen, 0.0, scale);
  for (const PlotLevel& level : plot.levels) {
    if (!anything || level.value < values.high * 3.0) seen.push_back(level.value);
  }
  AxisRange range = range_of(seen, kMargin, scale);
  const bool has_negative = std::any_of(seen.begin(), seen.end(), [](double y) { return y < 0.0; });
  if (scale == AxisScale::kLinear && plot.y_from_zero && !has_negative) range.low = 0.0;
  return range;
}

AxisRange x_extent(const Plot& plot) {
  if (plot.x_limits) return *plot.x_limits;
  std::optional<AxisRange> range;
  for (const PlotSeries& series : plot.series) {
    if (series.x.empty()) continue;
    const AxisRange one{series.x.front(), series.x.back()};
    range = range ? unite(*range, one) : one;
  }
  if (!range) return {};
  return range->span() > 0.0 ? *range : AxisRange{range->low - 0.5, range->high + 0.5};
}

void set_ranges(const Plot& plot, const PlotView& view, PlotPaint& paint) {
  const PlotAxes axes = axes_of(plot, view);
  paint.x.range = axes.x;
  paint.y.scale = axes.y_scale;
  paint.y.range = axes.y;
}

/// Wheel, drags and double click on the plot's area.
void handle_mouse(const PlotPaint& paint, PlotView& view, PlotResponse& response) {
  const ImGuiIO& io = ImGui::GetIO();
  const auto mouse_x = static_cast<double>(io.MousePos.x), mouse_y = static_cast<double>(io.MousePos.y);
  const bool hovered = ImGui::IsItemHovered();
  if (hovered) response.hovered_x = paint.x.to_value(mouse_x);
  if (hovered && io.MouseWheel != 0.0F) {
    const double factor = std::pow(kWheelFactor, -io.MouseWheel);
    if (io.KeyCtrl)
      view.y = zoomed(paint.y, mouse_y, factor);
    else
      view.x = zoomed(paint.x, mouse_x, factor);
  }
  if (hovered && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
    view.x.reset();
    view.y.reset();
    return;
  }
  if (!ImGui::IsItemActive()) return;
  for (const int button : {ImGuiMouseButton_Right, ImGuiMouseButton_Middle}) {
    if (!ImGui::IsMouseDragging(button)) continue;
    if (io.MouseDelta.x != 0.0F) view.x = panned(paint.x, static_cast<double>(io.MouseDelta.x));
    if (io.MouseDelta.y != 0.0F && view.y) view.y = panned(paint.y, static_cast<double>(io.MouseDelta.y));
  }
  if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) response.clicked_x = paint.x.to_value(mouse_x);
}

/// Leaves room beside the area for ticks and labels; y ticks decide how much.
void lay_out(const UiFrame& frame, const Plot& plot, ImVec2 low, ImVec2 high, PlotPaint& paint) {
  const float scale = frame.scale;
  const float line = frame.fonts.small->FontSize;
  paint.low = {low.x, low.y + (plot.legend || !plot.y_label.empty() ? line + 8.0F * scale : 4.0F * scale)};
  paint.high = {high.x - 10.0F * scale, high.y - line - 6.0F * scale};
  if (!plot.x_label.empty()) paint.high.y -= line + 2.0F * scale;
  paint.y.pixel_low = static_cast<double>(paint.high.y);
  paint.y.pixel_high = static_cast<double>(paint.low.y);
  const int most_y = std::max(2, static_cast<int>((paint.high.y - paint.low.y) / (kPixelsATickY * scale)));
  paint.y_ticks = paint.y.scale == AxisScale::kLog ? log_ticks(paint.y.range, most_y)
                                                   : linear_ticks(paint.y.range, most_y);
  float widest = 0.0F;
  for (const AxisTick& tick : paint.y_ticks) widest = std::max(widest, paint.text_size(tick.label).x);
  paint.low.x = low.x + widest + 12.0F * scale;
  paint.x.pixel_low = static_cast<double>(paint.low.x);
  paint.x.pixel_high = static_cast<double>(paint.high.x);
  const int most_x = std::max(2, static_cast<int>((paint.high.x - paint.low.x) / (kPixelsATickX * scale)));
  paint.x_ticks = linear_ticks(paint.x.range, most_x, plot.x_step);
}

}  // namespace

PlotAxes axes_of(const Plot& plot, const PlotView& view) {
  PlotAxes axes;
  axes.x = view.x.value_or(x_extent(plot));
  axes.y_scale = view.log_y ? AxisScale::kLog : AxisScale::kLinear;
  const bool usable = view.y && (!view.log_y || view.y->low > 0.0);
  axes.y = usable ? *view.y : y_extent(plot, axes.x, axes.y_scale);
  return axes;
}

PlotResponse draw_plot(const UiFrame& frame, const char* id, const Plot& plot, PlotView& view, ImVec2 size) {
  const ImVec2 available = ImGui::GetContentRegionAvail();
  if (size.x <= 0.0F) size.x = available.x;
  if (size.y <= 0.0F) size.y = available.y;
  size = {std::max(size.x, 80.0F * frame.scale), std::max(size.y, 60.0F * frame.scale)};
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 high{low.x + size.x, low.y + size.y};

  PlotPaint paint(frame);
  set_ranges(plot, view, paint);
  lay_out(frame, plot, low, high, paint);

  PlotResponse response;
  ImGui::PushID(id);
  ImGui::SetCursorScreenPos(paint.low);
  ImGui::InvisibleButton(
      "area", {std::max(1.0F, paint.high.x - paint.low.x), std::max(1.0F, paint.high.y - paint.low.y)},
      ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
          ImGuiButtonFlags_MouseButtonMiddle);
  handle_mouse(paint, view, response);
  offer_by_right_click(frame, "plot", ImGui::IsItemHovered(),
                       [&] { return std::vector{offer_of(id, plot, view)}; });
  // What the mouse changed shows in this frame, not the next.
  set_ranges(plot, view, paint);
  lay_out(frame, plot, low, high, paint);

  paint.ground(plot);
  paint.axes(plot, low, high);
  paint.clip();
  for (const PlotBand& band : plot.bands) paint.band(band);
  for (const PlotSeries& series : plot.series) paint.series(series);
  for (const PlotLevel& level : plot.levels) paint.level(level);
  for (const PlotLevel& mark : plot.marks) paint.mark(mark);
  if (plot.cursor_x) paint.cursor(*plot.cursor_x);
  paint.unclip();
  paint.heading(plot, low, high);
  if (response.hovered_x) paint.hover(plot, *response.hovered_x);
  // What follows goes below the whole plot, not below its area.
  ImGui::SetCursorScreenPos(low);
  ImGui::Dummy(size);
  ImGui::PopID();
  return response;
}

}  // namespace stillpoint
