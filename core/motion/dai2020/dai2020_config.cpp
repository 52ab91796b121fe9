#include "core/motion/dai2020/dai2020_config.hpp"

namespace stillpoint {

void Dai2020Config::list(ParameterTable& table) {
  table.number("window_px", window_px, 15, 5, 51, "px",
               "side of the Lucas-Kanade window that follows points");
  table.number("levels", levels, 3, 0, 8, "", "pyramid levels above the image itself");
  table.number("forward_backward_px", forward_backward_px, 1.0, 0.05, 20, "px",
               "a point followed there and back again may miss by so much");
  table.number("pixel_sigma_px", pixel_sigma_px, 1.0, 0.05, 10, "px",
               "standard deviation of where a point is, in each direction");
  table.number("depth_sigma_per_m2", depth_sigma_per_m2, 1.425e-3, 1e-5, 0.1, "1/m",
               "a depth z has standard deviation this times z squared");
  table.number("depth_floor_m", depth_floor_m, 0.0, 0.0, 1.0, "m",
               "and a part that does not grow with depth");
  table.number("spacing_px", spacing_px, 8.0, 1, 100, "px",
               "a feature nearer than this to a point of the graph becomes none");
  table.number("most_edge_m", most_edge_m, 1.0, 0.01, 100, "m",
               "edges that are longer, and longer than least_dropped_px, are left out");
  table.number("most_step_m", most_step_m, 0.3, 0.001, 100, "m",
               "as are those whose ends differ more in depth; a feature takes after no point so far off");
  table.number("least_dropped_px", least_dropped_px, 60.0, 0, 1000, "px",
               "shorter edges are never left out: those across an outline must exist to be cut");
  table.number("keyframe_frames", keyframe_frames, 5, 1, 100, "frames",
               "every so many frames new points come in and all are triangulated anew");
  table.number("cut_sigmas", cut_sigmas, 3.0, 0.1, 100, "sigma",
               "an edge is strained that is so far from its mean length");
  table.number("cut_count", cut_count, 2, 1, 32, "frames", "an edge strained in so many ...");
  table.number("cut_window", cut_window, 5, 1, 32, "frames", "... of its last so many frames is cut");
  table.number("mend_sigmas", mend_sigmas, 2.0, 0.1, 100, "sigma",
               "a cut edge is calm that is no farther from its mean length");
  table.number("mend_frames", mend_frames, 10, 1, 300, "frames", "after so many calm frames it is mended");
  table.number("settle_frames", settle_frames, 10, 1, 100, "frames",
               "an edge measured in fewer frames joins no points");
  table.number("least_group", least_group, 5, 1, 1000, "points", "smaller groups are undecided");
  table.choice("group_by", group_by, "count", {"count", "hull_area"},
               "the static group is the largest by points, or by the area of their hull");
  table.number("reach_px", reach_px, 12.0, 0, 200, "px",
               "a feature takes after the nearest judged point no farther away");
}

Dai2020Config Dai2020Config::for_camera(const Camera& camera) const {
  Dai2020Config fitted = *this;
  if (camera.is_stereo()) fitted.depth_sigma_per_m2 = camera.depth_sigma_per_m2;
  return fitted;
}

}  // namespace stillpoint
