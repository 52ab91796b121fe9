#include "ui/plot/plot_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace stillpoint {
namespace {

/// The samples that fall into one column of pixels.
class Column {
 public:
  void add(std::size_t index, double y) {
    if (empty_) first_ = least_ = greatest_ = index;
    if (empty_ || y < least_y_) least_ = index, least_y_ = y;
    if (empty_ || y > greatest_y_) greatest_ = index, greatest_y_ = y;
    last_ = index;
    empty_ = false;
  }

  void flush(std::span<const double> x, std::span<const double> y, std::vector<PlotSample>& samples) {
    if (empty_) return;
    std::array<std::size_t, 4> kept{first_, least_, greatest_, last_};
    std::sort(kept.begin(), kept.end());
    const auto end = std::unique(kept.begin(), kept.end());
    for (auto index = kept.begin(); index != end; ++index) samples.push_back({x[*index], y[*index]});
    empty_ = true;
  }

 private:
  bool empty_ = true;
  std::size_t first_ = 0, least_ = 0, greatest_ = 0, last_ = 0;
  double least_y_ = 0.0, greatest_y_ = 0.0;
};

}  // namespace

std::vector<PlotSample> decimate(std::span<const double> x, std::span<const double> y, const AxisRange& range,
                                 int columns) {
  std::vector<PlotSample> samples;
  if (x.empty() || columns < 1 || !(range.span() > 0.0)) return samples;
  // One sample beyond either end, so that lines run to the edge.
  auto begin = static_cast<std::size_t>(std::lower_bound(x.begin(), x.end(), range.low) - x.begin());
  auto end = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), range.high) - x.begin());
  begin = begin > 0 ? begin - 1 : 0;
  end = std::min(end + 1, x.size());

  Column column;
  long current = std::numeric_limits<long>::min();
  for (std::size_t i = begin; i < end; ++i) {
    if (!std::isfinite(y[i])) {
      column.flush(x, y, samples);
      const bool after_values = !samples.empty() && !std::isnan(samples.back().y);
      if (after_values) samples.push_back({x[i], std::nan("")});
      continue;
    }
    const auto here = static_cast<long>(std::floor((x[i] - range.low) / range.span() * columns));
    if (here != current) column.flush(x, y, samples);
    current = here;
    column.add(i, y[i]);
  }
  column.flush(x, y, samples);
  return samples;
}

std::optional<std::size_t> nearest_index(std::span<const double> x, double value) {
  if (x.empty()) return std::nullopt;
  const auto above = std::lower_bound(x.begin(), x.end(), value);
  if (above == x.begin()) return 0;
  const auto index = static_cast<std::size_t>(above - x.begin());
  if (above == x.end()) return index - 1;
  return value - x[index - 1] <= x[index] - value ? index - 1 : index;
}

}  // namespace stillpoint
