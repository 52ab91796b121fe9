#include "core/motion/peng2017/peng2017_config.hpp"

namespace stillpoint {

void Peng2017Config::list(ParameterTable& table) {
  table.number("window_px", window_px, 15, 5, 51, "px",
               "side of the Lucas-Kanade window that follows features");
  table.number("levels", levels, 3, 0, 8, "", "pyramid levels above the image itself");
  table.number("forward_backward_px", forward_backward_px, 1.0, 0.05, 20, "px",
               "a feature followed there and back again may miss by so much");
  table.number("pixel_sigma_px", pixel_sigma_px, 1.0, 0.05, 10, "px",
               "standard deviation of where a feature is, in each direction");
  table.number("depth_sigma_per_m2", depth_sigma_per_m2, 1.425e-3, 1e-5, 0.1, "1/m",
               "a depth z has standard deviation this times z squared");
  table.number("depth_floor_m", depth_floor_m, 0.0, 0.0, 1.0, "m",
               "and a part that does not grow with depth");
  table.number("spacing_px", spacing_px, 8.0, 1, 100, "px",
               "of features nearer to each other than this the first is a point of the graph");
  table.number("most_edge_m", most_edge_m, 1.0, 0.01, 100, "m",
               "edges that are longer, and longer than least_dropped_px, are left out");
  table.number("most_step_m", most_step_m, 0.3, 0.001, 100, "m",
               "as are those whose ends differ more in depth; a feature takes after no point so far off");
  table.number("least_dropped_px", least_dropped_px, 60.0, 0, 1000, "px",
               "shorter edges are never left out: those across an outline must exist to be cut");
  table.number("cut_sigmas", cut_sigmas, 3.0, 0.1, 100, "sigma",
               "an edge is cut whose length changed by more since the last frame");
  table.number("held_share", held_share, 0.5, 0.0, 1.0, "",
               "a point is static when more than this share of its edges hold");
  table.number("reach_px", reach_px, 12.0, 0, 200, "px",
               "a feature takes after the nearest judged point no farther away");
}

Peng2017Config Peng2017Config::for_camera(const Camera& camera) const {
  Peng2017Config fitted = *this;
  if (camera.is_stereo()) fitted.depth_sigma_per_m2 = camera.depth_sigma_per_m2;
  return fitted;
}

}  // namespace stillpoint
