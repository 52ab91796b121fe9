#include "core/run/figure_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/odometry/frame_record.hpp"

namespace stillpoint {
namespace {

std::vector<std::size_t> sorted_places(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&values](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  return order;
}

/// Equal values share the mean of their ranks.
std::vector<double> ranks(const std::vector<double>& values) {
  const std::vector<std::size_t> order = sorted_places(values);
  std::vector<double> ranks(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last + 1 < order.size() && values[order[last + 1]] == values[order[first]]) ++last;
    for (std::size_t i = first; i <= last; ++i) ranks[order[i]] = 0.5 * static_cast<double>(first + last);
    first = last + 1;
  }
  return ranks;
}

}  // namespace

FigurePairs figure_pairs(const MeasuredFrames& measured, int x, int y) {
  const std::vector<double> all_x = frame_figure_values(measured, x),
                            all_y = frame_figure_values(measured, y);
  FigurePairs known, pairs;
  std::size_t row = 0;
  for (const FrameOutline& frame : measured.records.outlines()) {
    const double of_x = all_x[row], of_y = all_y[row];
    ++row;
    if (!std::isfinite(of_x) || !std::isfinite(of_y)) continue;
    known.x.push_back(of_x);
    known.y.push_back(of_y);
    known.frames.push_back(frame.index);
  }
  for (const std::size_t i : sorted_places(known.x)) {
    pairs.x.push_back(known.x[i]);
    pairs.y.push_back(known.y[i]);
    pairs.frames.push_back(known.frames[i]);
  }
  return pairs;
}

std::optional<double> rank_correlation(const FigurePairs& pairs) {
  const std::size_t count = pairs.x.size();
  if (count < 3) return std::nullopt;
  const std::vector<double> x = ranks(pairs.x), y = ranks(pairs.y);
  const double mean = 0.5 * static_cast<double>(count - 1);
  double xx = 0.0, yy = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    xx += (x[i] - mean) * (x[i] - mean), yy += (y[i] - mean) * (y[i] - mean);
    xy += (x[i] - mean) * (y[i] - mean);
  }
  if (!(xx > 0.0 && yy > 0.0)) return std::nullopt;
  return xy / std::sqrt(xx * yy);
}

}  // namespace stillpoint
