#include "ui/plot/plot_axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stillpoint {
namespace {

/// The smallest of 1, 2, 5 times a power of ten that is not below `step`.
double round_step(double step) {
  const double decade = std::pow(10.0, std::floor(std::log10(step)));
  for (const double leading : {1.0, 2.0, 5.0}) {
    // A whisker of slack, so that a step that is round already stays.
    if (leading * decade >= step * (1.0 - 1e-9)) return leading * decade;
  }
  return 10.0 * decade;
}

/// A tick's label, so many decimals that neighbours `step` apart differ.
std::string tick_label(double value, double step) {
  const double magnitude = std::max(std::abs(value), step);
  if (value == 0.0) return "0";
  if (magnitude >= 1e6 || magnitude < 1e-4) return fmt::format("{:.3g}", value);
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  return fmt::format("{:.{}f}", value, decimals);
}

bool is_usable(const AxisRange& range) {
  return std::isfinite(range.low) && std::isfinite(range.high) && range.high > range.low;
}

}  // namespace

std::vector<AxisTick> linear_ticks(const AxisRange& range, int most, double least) {
  std::vector<AxisTick> ticks;
  if (!is_usable(range) || most < 1) return ticks;
  double step = round_step(range.span() / most);
  const auto count = [&range](double s) {
    return std::floor(range.high / s + 1e-9) - std::ceil(range.low / s - 1e-9) + 1;
  };
  while (count(step) > most) step = round_step(step * 1.5);
  // One tick alone tells no scale: a low plot of 0 to 495 has 0 and 400.
  if (most > 1 && count(step) < 2) {
    double finer = step;
    for (int i = 0; i < 3 && count(finer) < 2; ++i) finer = round_step(finer / 2.6);
    for (int times = 1; times <= 4; ++times)
      if (const double some = count(times * finer); some >= 2 && some <= most) {
        step = times * finer;
        break;
      }
  }
  step = std::max(step, least);
  const double first = std::ceil(range.low / step - 1e-9);
  for (int i = 0; i < static_cast<int>(count(step)); ++i) {
    // Whole multiples, not sums: a sum would miss zero by rounding.
    const double value = (first + i) * step;
    ticks.push_back({value, tick_label(value, step), true});
  }
  return ticks;
}

std::vector<AxisTick> log_ticks(const AxisRange& range, int most) {
  std::vector<AxisTick> ticks;
  if (!is_usable(range) || range.low <= 0.0 || most < 1) return ticks;
  const double decades = std::log10(range.high / range.low);
  const int first = static_cast<int>(std::floor(std::log10(range.low) - 1e-9));
  const int last = static_cast<int>(std::ceil(std::log10(range.high) + 1e-9));
  const int every = std::max(1, static_cast<int>(std::ceil(decades / most)));
  for (int exponent = first; exponent <= last; ++exponent) {
    const double decade = std::pow(10.0, exponent);
    for (int leading = 1; leading < 10; ++leading) {
      if (leading > 1 && decades >= 4.0) break;
      const double value = leading * decade;
      if (value < range.low * (1.0 - 1e-9) || value > range.high * (1.0 + 1e-9)) continue;
      const bool whole = leading == 1 && exponent % every == 0;
      const bool major = whole || ((leading == 2 || leading == 5) && decades < 1.5);
      ticks.push_back({value, major ? fmt::format("{:g}", value) : "", major});
    }
  }
  return ticks;
}

AxisRange unite(const AxisRange& a, const AxisRange& b) {
  return {std::min(a.low, b.low), std::max(a.high, b.high)};
}

double AxisMap::to_pixel(double value) const {
  double share = 0.0;
  if (scale == AxisScale::kLinear)
    share = (value - range.low) / range.span();
  else if (value > 0.0)
    share = std::log(value / range.low) / std::log(range.high / range.low);
  else
    return std::nan("");
  return pixel_low + share * (pixel_high - pixel_low);
}

double AxisMap::to_value(double pixel) const {
  const double share = (pixel - pixel_low) / (pixel_high - pixel_low);
  if (scale == AxisScale::kLinear) return range.low + share * range.span();
  return range.low * std::pow(range.high / range.low, share);
}

AxisRange zoomed(const AxisMap& map, double pixel, double factor) {
  return {map.to_value(pixel + (map.pixel_low - pixel) * factor),
          map.to_value(pixel + (map.pixel_high - pixel) * factor)};
}

AxisRange panned(const AxisMap& map, double delta) {
  return {map.to_value(map.pixel_low - delta), map.to_value(map.pixel_high - delta)};
}

std::string format_value(double value, std::string_view unit) {
  if (std::isnan(value)) return "–";
  std::string text = fmt::format("{:.4g}", value);
  if (!unit.empty()) text.append(" ").append(unit);
  return text;
}

namespace detail {

bool counts(double value, AxisScale scale) {
  return std::isfinite(value) && (scale == AxisScale::kLinear || value > 0.0);
}

AxisRange padded_range(double low, double high, double margin, AxisScale scale) {
  if (low > high) return scale == AxisScale::kLinear ? AxisRange{0.0, 1.0} : AxisRange{0.1, 1.0};
  if (scale == AxisScale::kLog) {
    if (low == high) return {low / 2.0, high * 2.0};
    const double factor = std::pow(high / low, margin);
    return {low / factor, high * factor};
  }
  if (low == high) {
    const double half = low == 0.0 ? 1.0 : 0.5 * std::abs(low);
    return {low - half, high + half};
  }
  return {low - margin * (high - low), high + margin * (high - low)};
}

}  // namespace detail

}  // namespace stillpoint
