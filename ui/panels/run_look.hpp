#pragma once

#include "ui/panels/panel_kit.hpp"
#include "ui/plot/plot.hpp"

namespace stillpoint {

/// How a run is told from the others wherever runs lie over one another: by colour, and without it by its
/// line's dashes and its sign.
struct RunLook {
  Rgb colour;
  SeriesStyle line = SeriesStyle::kLine;
  Sign sign = Sign::kLine;
  double dash = 0.0;  ///< of its path in the trajectory view, as a share of the path's extent; 0 = unbroken
};

/// The look with this number, of those that ghosts have.
[[nodiscard]] RunLook ghost_look(std::size_t number, ThemeName theme);
/// Of one of a session's ghosts, the same in every panel, whichever others are there.
[[nodiscard]] RunLook ghost_look(const std::vector<GhostView>& ghosts, std::size_t index, ThemeName theme);

/// A run's name where there is little room, cut with an ellipsis.
[[nodiscard]] std::string shortened(const std::string& name, std::size_t most = 30);

}  // namespace stillpoint
