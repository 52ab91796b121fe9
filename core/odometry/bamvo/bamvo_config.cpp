#include "core/odometry/bamvo/bamvo_config.hpp"

namespace stillpoint {

void BamvoConfig::list(ParameterTable& table) {
  table.number("image_factor", image_factor, 2, 1, 8, "px",
               "full-size pixels a side of one of the images aligned; the background model halves them once "
               "more");
  table.number("history", history, 4, 2, 10, "frames",
               "depth images of the background model: the last one and those warped into it");
  table.number("nearest_m", nearest_m, 0.5, 0.05, 10, "m", "nearer depth counts nowhere");
  table.number("farthest_m", farthest_m, 5.0, 0.1, 50, "m", "farther depth counts nowhere");
  table.number("least_sigma_m", least_sigma_m, 0.001, 1e-6, 1, "m", "least bandwidth of a pixel's density");
  table.flag("weigh_by_depth", weigh_by_depth, true,
             "a pixel's density is multiplied by its depth, as noise grows with depth");
  table.number("bilateral_px", bilateral_px, 5, 1, 15, "px",
               "diameter of the bilateral filter over the densities");
  table.number("bilateral_sigma", bilateral_sigma, 0.02, 1e-4, 1000, "",
               "its sigmas, of density and of pixels alike");
  table.number("foreground_change_m", foreground_change_m, 1.96 * 0.01623, 0.001, 1, "m",
               "a pixel is foreground when its depth changed by more, in the median");
  table.number("iterations", iterations, 10, 1, 100, "steps", "most Gauss-Newton steps a level");
  table.number("max_depth_difference_m", max_depth_difference_m, 0.2, 0.001, 10, "m",
               "a pixel counts when its depth is met so nearly where it is warped to");
  table.number("student_freedom", student_freedom, 5.0, 0.5, 100, "",
               "degrees of freedom of the residuals' t distribution");
  table.number("max_motion", max_motion, 0.4, 0.01, 10, "",
               "a motion of a longer logarithm (m and rad) has failed, and the history is emptied");
  table.number("min_pixels", min_pixels, 500, 10, 1000000, "px", "with fewer that count the frame is lost");
  table.number("patience", patience, 5, 0, 1000, "frames",
               "so many lost frames are aligned with the last good one; then the history begins anew");
}

BamvoConfig BamvoConfig::for_camera(const Camera& camera) const {
  BamvoConfig fitted = *this;
  fitted.farthest_m = camera.depth_limit(farthest_m);
  return fitted;
}

}  // namespace stillpoint
