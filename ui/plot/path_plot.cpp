#include "ui/plot/path_plot.hpp"

#include <algorithm>

namespace stillpoint {

PathPlot path_plot(std::span<const PlotPath> paths) {
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  constexpr double kMargin = 0.05;  // of the extent, at either end
  std::array<std::size_t, 3> axes{0, 1, 2};
  std::array<AxisRange, 3> extents;
  for (const std::size_t axis : axes) {
    std::vector<double> all;
    for (const PlotPath& path : paths)
      all.insert(all.end(), (*path.position)[axis].begin(), (*path.position)[axis].end());
    extents[axis] = range_of(all, kMargin, AxisScale::kLinear);
  }
  std::stable_sort(axes.begin(), axes.end(),
                   [&](std::size_t a, std::size_t b) { return extents[a].span() > extents[b].span(); });
  const std::size_t across = std::min(axes[0], axes[1]), up = std::max(axes[0], axes[1]);
  PathPlot made{.plot = {.x_label = kNames[across], .x_unit = "m", .y_label = kNames[up], .y_unit = "m"},
                .across = kNames[across],
                .up = kNames[up]};
  made.plot.y_from_zero = false;
  made.plot.equal_scale = true;
  made.plot.x_limits = extents[across];
  for (const PlotPath& path : paths)
    made.plot.series.push_back(
        {path.name, (*path.position)[across], (*path.position)[up], path.colour, path.style, path.width});
  return made;
}

}  // namespace stillpoint
