#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

// The arithmetic of plot axes, without drawing: ticks at round numbers, and values to pixels and back.

/// A stretch of values, low to high.
struct AxisRange {
  double low = 0.0, high = 1.0;
  [[nodiscard]] double span() const { return high - low; }
  bool operator==(const AxisRange&) const = default;
};

enum class AxisScale { kLinear, kLog };

struct AxisTick {
  double value = 0.0;
  std::string label;  ///< without unit; empty on minor ticks
  bool major = true;
};

/// Ticks at 1, 2 or 5 times powers of ten, at most `most` of them, labelled with as many digits as tell them
/// apart. An empty or non-finite range has none.
/// @param least how far apart they are at least: 1 where values between whole numbers are none, as of frames
[[nodiscard]] std::vector<AxisTick> linear_ticks(const AxisRange& range, int most, double least = 0.0);

/// Ticks at powers of ten, with unlabelled minor ones between when the range is under four decades; at 2 and
/// 5 labelled too when it is under one and a half. The range must be positive.
[[nodiscard]] std::vector<AxisTick> log_ticks(const AxisRange& range, int most);

/// The range that `values` span, enlarged by `margin` of itself at either end; NaN and infinity are passed
/// over, and on a log scale what is not positive. Values all alike get a range around them; none at all, 0 to
/// 1 (log 0.1 to 1).
template <typename Values>
[[nodiscard]] AxisRange range_of(const Values& values, double margin, AxisScale scale);

/// Both in one.
[[nodiscard]] AxisRange unite(const AxisRange& a, const AxisRange& b);

/// Maps values to pixels: range.low falls on `pixel_low`, range.high on `pixel_high`, whichever is larger.
struct AxisMap {
  AxisRange range;
  AxisScale scale = AxisScale::kLinear;
  double pixel_low = 0.0, pixel_high = 1.0;

  /// NaN for a value not positive on a log scale.
  [[nodiscard]] double to_pixel(double value) const;
  [[nodiscard]] double to_value(double pixel) const;
};

/// The range after zooming by `factor` (< 1 is nearer) about `pixel`, whose value stays where it is.
[[nodiscard]] AxisRange zoomed(const AxisMap& map, double pixel, double factor);

/// The range after dragging the content by `delta` pixels.
[[nodiscard]] AxisRange panned(const AxisMap& map, double delta);

/// A value as it is read out: four significant digits, no trailing zeros, and its unit ("12.5 mm").
[[nodiscard]] std::string format_value(double value, std::string_view unit);

// ---------------------------------------------------------------------------------------------------------------

namespace detail {
[[nodiscard]] AxisRange padded_range(double low, double high, double margin, AxisScale scale);
[[nodiscard]] bool counts(double value, AxisScale scale);
}  // namespace detail

template <typename Values>
AxisRange range_of(const Values& values, double margin, AxisScale scale) {
  double low = 1.0, high = 0.0;
  for (const double value : values) {
    if (!detail::counts(value, scale)) continue;
    if (low > high) low = high = value;
    low = value < low ? value : low;
    high = value > high ? value : high;
  }
  return detail::padded_range(low, high, margin, scale);
}

}  // namespace stillpoint
