#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "ui/plot/plot.hpp"

namespace stillpoint {

/// A camera's way for a flat plot; the coordinates must outlive it.
struct PlotPath {
  std::string name;
  const std::array<std::vector<double>, 3>* position = nullptr;  ///< m: x, y and z
  Rgb colour;
  SeriesStyle style = SeriesStyle::kLine;
  float width = 1.5F;
};

/// Paths in one scale, seen from the side that shows most of them.
struct PathPlot {
  Plot plot;
  const char *across = "x", *up = "y";  ///< the two axes in which the paths reach furthest, in their order
};
[[nodiscard]] PathPlot path_plot(std::span<const PlotPath> paths);

}  // namespace stillpoint
