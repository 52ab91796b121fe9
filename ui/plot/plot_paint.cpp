#include "ui/plot/plot_paint.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ui/shell/ui_frame.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/rounded.hpp"
#include "ui/theme/text.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {
namespace {

constexpr float kDash = 6.0F, kGap = 4.0F;  // design px
constexpr float kSwatchLength = 16.0F;      // design px: a broken line shows its pattern

/// A stroke of a broken line's pattern, design px from where the pattern begins.
struct Stroke {
  float begin = 0.0F, length = kDash;
};

std::vector<Stroke> strokes_of(SeriesStyle style) {
  constexpr float kDot = 2.0F;  // design px
  if (style == SeriesStyle::kDotted) return {{0.0F, kDot}};
  if (style == SeriesStyle::kDashDot) return {{0.0F, 2.0F * kDash}, {2.0F * kDash + kGap, kDot}};
  return {{0.0F, kDash}};
}

bool is_broken(SeriesStyle style) {
  return style == SeriesStyle::kDashed || style == SeriesStyle::kDotted || style == SeriesStyle::kDashDot;
}

/// Whether a line turns by more than 60° at `at`.
bool is_sharp(ImVec2 before, ImVec2 at, ImVec2 after) {
  constexpr float kCosine = 0.5F;  // of 60°: corners that are sharper are drawn pointed
  const ImVec2 in{at.x - before.x, at.y - before.y}, out{after.x - at.x, after.y - at.y};
  return in.x * out.x + in.y * out.y < kCosine * std::hypot(in.x, in.y) * std::hypot(out.x, out.y);
}

std::string with_unit(const std::string& label, const std::string& unit) {
  return unit.empty() ? label : label.empty() ? unit : label + " (" + unit + ")";
}

}  // namespace

ImVec2 PlotPaint::text_size(const std::string& words) const {
  const ImFont* font = frame_.fonts.small;
  return font->CalcTextSizeA(font->FontSize, 1e6F, 0.0F, words.c_str());
}

ImVec2 PlotPaint::place(double value_x, double value_y) const {
  // Far outside the area positions only need to be outside; beyond what a float holds they would break the
  // line.
  const double py = std::clamp(y.to_pixel(value_y), -1e5, 1e5),
               px = std::clamp(x.to_pixel(value_x), -1e5, 1e5);
  return {static_cast<float>(px), static_cast<float>(py)};
}

void PlotPaint::text(ImVec2 at, const std::string& words, ImU32 colour) const {
  list_.AddText(frame_.fonts.small, frame_.fonts.small->FontSize, {std::round(at.x), std::round(at.y)},
                colour, words.c_str());
}

void PlotPaint::label(ImVec2 at, const std::string& words, Rgb colour) const {
  const float gap = 2.0F * frame_.scale;
  const ImVec2 extent = text_size(words);
  if (!words.empty())
    list_.AddRectFilled({at.x - gap, at.y}, {at.x + extent.x + gap, at.y + extent.y},
                        to_u32(frame_.theme.plot, 0.8F), gap);
  text(at, words, to_u32(colour));
}

void PlotPaint::ground(const Plot&) const { fill_rounded(list_, low, high, to_u32(frame_.theme.plot), 2.0F); }

void PlotPaint::axes(const Plot& plot, ImVec2, ImVec2 outer_high) const {
  const ImU32 grid = to_u32(frame_.theme.grid), faint = to_u32(frame_.theme.grid, 0.45F);
  const ImU32 ink = to_u32(frame_.theme.text_dim);
  const float gap = 6.0F * frame_.scale;
  float lowest = std::numeric_limits<float>::max();
  for (const AxisTick& tick : y_ticks) {
    const float at = std::round(place(x.range.low, tick.value).y);
    list_.AddLine({low.x, at}, {high.x, at}, tick.major ? grid : faint);
    const ImVec2 extent = text_size(tick.label);
    // In a low plot some lines go without their number.
    if (lowest - at < 0.9F * extent.y) continue;
    lowest = at;
    text({low.x - gap - extent.x, at - 0.5F * extent.y}, tick.label, ink);
  }
  for (const AxisTick& tick : x_ticks) {
    const float at = std::round(static_cast<float>(x.to_pixel(tick.value)));
    list_.AddLine({at, low.y}, {at, high.y}, grid);
    const ImVec2 extent = text_size(tick.label);
    // The outermost labels stay within the plot.
    const float left = std::min(at - 0.5F * extent.x, outer_high.x - extent.x);
    text({left, high.y + 4.0F * frame_.scale}, tick.label, ink);
  }
  if (plot.x_label.empty()) return;
  const std::string label = with_unit(plot.x_label, plot.x_unit);
  const ImVec2 extent = text_size(label);
  text({0.5F * (low.x + high.x - extent.x), outer_high.y - extent.y}, label, ink);
}

void PlotPaint::clip() const { list_.PushClipRect(low, high, true); }

void PlotPaint::unclip() const { list_.PopClipRect(); }

void PlotPaint::band(const PlotBand& band) const {
  // However short, a band is seen.
  const float from = place(band.x.low, y.range.low).x;
  const float to = std::max(place(band.x.high, y.range.low).x, from + 2.0F);
  list_.AddRectFilled({from, low.y}, {to, high.y}, to_u32(band.colour, band.opacity));
}

void PlotPaint::dashed(ImVec2 from, ImVec2 to, ImU32 colour, float width, float& phase,
                       SeriesStyle style) const {
  const float length = std::hypot(to.x - from.x, to.y - from.y);
  if (!(length > 0.0F)) return;
  const auto at = [&](float along) {
    return ImVec2{from.x + (to.x - from.x) * along / length, from.y + (to.y - from.y) * along / length};
  };
  const std::vector<Stroke> strokes = strokes_of(style);
  const float period = (strokes.back().begin + strokes.back().length + kGap) * frame_.scale;
  for (float along = -phase; along < length; along += period) {
    for (const Stroke& stroke : strokes) {
      const float begin = along + stroke.begin * frame_.scale, end = begin + stroke.length * frame_.scale;
      if (end > 0.0F && begin < length)
        list_.AddLine(at(std::max(begin, 0.0F)), at(std::min(end, length)), colour, width);
    }
  }
  phase = std::fmod(phase + length, period);
}

void PlotPaint::line(const PlotSeries& series, const std::vector<PlotSample>& samples) const {
  const ImU32 colour = to_u32(series.colour);
  const float width = series.width_px * frame_.scale;
  const auto drawable = [this](const PlotSample& sample) { return !std::isnan(y.to_pixel(sample.y)); };
  float phase = 0.0F;
  for (std::size_t i = 0; i < samples.size();) {
    if (!drawable(samples[i])) {
      ++i;
      continue;
    }
    std::vector<ImVec2> run;
    for (; i < samples.size() && drawable(samples[i]); ++i) {
      const ImVec2 here = place(samples[i].x, samples[i].y);
      if (series.style == SeriesStyle::kSteps && !run.empty()) run.push_back({here.x, run.back().y});
      run.push_back(here);
    }
    if (run.size() == 1) {
      list_.AddCircleFilled(run[0], std::max(1.5F, width), colour);
    } else if (is_broken(series.style)) {
      for (std::size_t k = 1; k < run.size(); ++k)
        dashed(run[k - 1], run[k], colour, width, phase, series.style);
    } else {
      joined(run, colour, width);
    }
  }
}

void PlotPaint::joined(const std::vector<ImVec2>& run, ImU32 colour, float width) const {
  // ImGui mitres its joints: at sharp turns, as in a spike, the line before and after becomes thin and the
  // tip overshoots. There the line ends, and goes on under a round joint.
  std::size_t begin = 0;
  const auto draw_to = [&](std::size_t end) {
    list_.AddPolyline(run.data() + begin, static_cast<int>(end - begin) + 1, colour, ImDrawFlags_None, width);
    begin = end;
  };
  for (std::size_t i = 1; i + 1 < run.size(); ++i) {
    if (!is_sharp(run[i - 1], run[i], run[i + 1])) continue;
    draw_to(i);
    list_.AddCircleFilled(run[i], 0.5F * width, colour);
  }
  draw_to(run.size() - 1);
}

void PlotPaint::series(const PlotSeries& series) const {
  const ImU32 colour = to_u32(series.colour);
  if (series.style == SeriesStyle::kBars) {
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (!std::isfinite(series.y[i]) || std::isnan(y.to_pixel(series.y[i]))) continue;
      // A bar reaches to the next value; the last is as wide as the one before.
      const double width = i + 1 < series.x.size() ? series.x[i + 1] - series.x[i]
                           : i > 0                 ? series.x[i] - series.x[i - 1]
                                                   : 1.0;
      const ImVec2 top = place(series.x[i], series.y[i]);
      const float right = std::max(place(series.x[i] + width, series.y[i]).x, top.x + 1.0F);
      list_.AddRectFilled({top.x, top.y}, {right, high.y}, colour);
    }
    return;
  }
  const int columns = std::max(1, static_cast<int>(high.x - low.x));
  const std::vector<PlotSample> samples = decimate(series.x, series.y, x.range, columns);
  if (series.style != SeriesStyle::kDots) {
    line(series, samples);
    return;
  }
  for (const PlotSample& sample : samples) {
    if (!std::isnan(y.to_pixel(sample.y))) {
      list_.AddCircleFilled(place(sample.x, sample.y), series.width_px * 1.5F * frame_.scale, colour);
    }
  }
}

void PlotPaint::level(const PlotLevel& level) const {
  if (std::isnan(y.to_pixel(level.value))) return;
  const float at = std::round(place(x.range.low, level.value).y);
  float phase = 0.0F;
  dashed({low.x, at}, {high.x, at}, to_u32(level.colour, 0.9F), frame_.scale, phase);
  const ImVec2 extent = text_size(level.name);
  // Near the upper edge the name goes below the line.
  const float above = at - extent.y - 1.0F;
  label({high.x - extent.x - 4.0F * frame_.scale, above < low.y ? at + 1.0F : above}, level.name,
        level.colour);
}

void PlotPaint::mark(const PlotLevel& mark) const {
  const float at = std::round(place(mark.value, y.range.low).x);
  float phase = 0.0F;
  dashed({at, low.y}, {at, high.y}, to_u32(mark.colour, 0.9F), 1.5F * frame_.scale, phase);
  const ImVec2 extent = text_size(mark.name);
  const bool to_the_left = at + extent.x + 8.0F * frame_.scale > high.x;
  const float gap = 4.0F * frame_.scale;
  label({to_the_left ? at - extent.x - gap : at + gap, low.y + gap}, mark.name, mark.colour);
}

void PlotPaint::cursor(double at_x) const {
  const float at = std::round(place(at_x, y.range.low).x);
  const ImU32 colour = to_u32(role_colour(Role::kCursor, frame_.theme.name));
  list_.AddLine({at, low.y}, {at, high.y}, colour, 1.5F * frame_.scale);
  const float side = 5.0F * frame_.scale;
  list_.AddTriangleFilled({at - side, low.y}, {at + side, low.y}, {at, low.y + 1.3F * side}, colour);
}

void PlotPaint::swatch(ImVec2 at, const PlotSeries& series) const {
  const float length = kSwatchLength * frame_.scale, half = 4.0F * frame_.scale;
  const ImU32 colour = to_u32(series.colour);
  float phase = 0.0F;
  if (series.style == SeriesStyle::kBars)
    list_.AddRectFilled({at.x, at.y - half}, {at.x + length, at.y + half}, colour);
  else if (series.style == SeriesStyle::kDots)
    list_.AddCircleFilled({at.x + 0.5F * length, at.y}, 0.7F * half, colour);
  else if (is_broken(series.style))
    dashed(at, {at.x + length, at.y}, colour, 2.0F * frame_.scale, phase, series.style);
  else
    list_.AddLine(at, {at.x + length, at.y}, colour, 2.0F * frame_.scale);
}

void PlotPaint::heading(const Plot& plot, ImVec2 outer_low, ImVec2 outer_high) const {
  const float gap = 6.0F * frame_.scale;
  const std::string label = with_unit(plot.y_label, plot.y_unit);
  const float label_width = text_size(label).x;
  text({outer_low.x + 2.0F, outer_low.y}, label, to_u32(frame_.theme.text_dim));
  if (!plot.legend) return;
  struct Name {
    const PlotSeries* series;
    float width;  // px
  };
  std::vector<Name> names;
  for (const PlotSeries& series : plot.series)
    if (!series.name.empty()) names.push_back({&series, text_size(series.name).x});
  const float step = (kSwatchLength + 6.0F) * frame_.scale + 2.0F * gap;
  const float room = outer_high.x - outer_low.x - label_width - 2.0F * gap;
  const auto needed = [&](float longest) {
    float sum = 0.0F;
    for (const Name& name : names) sum += step + std::min(name.width, longest);
    return sum;
  };
  // Where there is no room for all, the longest names are cut; then those drawn first go, as others lie over
  // them: what is drawn last is the run itself.
  const float least = 2.5F * frame_.fonts.small->FontSize;
  float longest = 1e6F;
  if (needed(longest) > room) {
    while (!names.empty() && needed(least) > room) names.erase(names.begin());
    for (longest = 40.0F * least; longest > least && needed(longest) > room;) longest -= 2.0F;
  }
  float left = outer_high.x - needed(longest);
  for (const Name& name : names) {
    const float width = std::min(name.width, longest);
    swatch({left, std::round(outer_low.y + 0.5F * frame_.fonts.small->FontSize)}, *name.series);
    text({left + step - 2.0F * gap, outer_low.y},
         name.width > width ? cut_to(*frame_.fonts.small, name.series->name, width) : name.series->name,
         to_u32(frame_.theme.text));
    left += step + width;
  }
}

void PlotPaint::hover(const Plot& plot, double at_x) const {
  const float at = std::round(place(at_x, y.range.low).x);
  list_.AddLine({at, low.y}, {at, high.y}, to_u32(frame_.theme.text_dim, 0.6F));
  ImGui::BeginTooltip();
  ImGui::PushFont(frame_.fonts.small);
  ImGui::TextDisabled("%s %s", plot.x_label.c_str(), format_value(at_x, plot.x_unit).c_str());
  for (const PlotSeries& series : plot.series) {
    const auto index = nearest_index(series.x, at_x);
    if (!index) continue;
    const double value = series.y[*index];
    if (series.style != SeriesStyle::kBars && !std::isnan(y.to_pixel(value))) {
      const ImVec2 dot = place(series.x[*index], value);
      if (dot.y >= low.y && dot.y <= high.y) {
        list_.AddCircleFilled(dot, 4.0F * frame_.scale, to_u32(frame_.theme.plot));
        list_.AddCircleFilled(dot, 3.0F * frame_.scale, to_u32(series.colour));
      }
    }
    ImGui::TextColored(to_vec4(series.colour), "■");
    ImGui::SameLine();
    ImGui::Text("%s  %s", series.name.c_str(), format_value(value, plot.y_unit).c_str());
  }
  ImGui::PopFont();
  ImGui::EndTooltip();
}

}  // namespace stillpoint
