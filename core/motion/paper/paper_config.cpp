#include "core/motion/paper/paper_config.hpp"

namespace stillpoint {

void PaperConfig::list(ParameterTable& table) {
  table.number("max_corners", max_corners, 600, 16, 20000, "corners", "corners followed per direction");
  table.number("corner_quality", corner_quality, 0.01, 1e-5, 1, "",
               "least corner response, as a share of the best corner's");
  table.number("corner_distance_px", corner_distance_px, 12.0, 1, 100, "px",
               "least distance between corners");
  table.number("flow_window_px", flow_window_px, 21, 5, 101, "px", "side of the Lucas-Kanade window");
  table.number("flow_levels", flow_levels, 3, 0, 8, "levels", "pyramid levels above the full image");
  table.number("flow_max_residual", flow_max_residual, 20.0, 0.1, 255, "grey levels",
               "mean absolute residual above which a track is dropped");
  table.number("ransac_threshold_px", ransac_threshold_px, 2.0, 0.1, 50, "px",
               "reprojection error that makes a track an inlier of the homography");
  table.number("ransac_confidence", ransac_confidence, 0.995, 0.5, 0.999999, "",
               "probability that RANSAC drew one outlier-free sample");
  table.number("ransac_iterations", ransac_iterations, 2000, 10, 100000, "samples",
               "most samples RANSAC draws");
  table.number("refine_iterations", refine_iterations, 20, 0, 200, "steps",
               "most Levenberg-Marquardt steps on eq. (4)");
  table.number("erode_kernel_px", erode_kernel_px, 4, 1, 99, "px", "side of the square erosion kernel");
  table.number("erode_iterations", erode_iterations, 2, 0, 20, "times", "how often the erosion is applied");
  table.number("dilate_kernel_px", dilate_kernel_px, 16, 1, 99, "px", "side of the square dilation kernel");
  table.number("dilate_iterations", dilate_iterations, 1, 0, 20, "times",
               "how often the dilation is applied");
  table.number("border_px", border_px, 3, 0, 200, "px",
               "margin beside the warp's border that counts as having no data");
  table.number("max_rounds", max_rounds, 3, 1, 20, "rounds", "rounds of removal and a better homography");
  table.number("converged_shift_px", converged_shift_px, 0.1, 0, 10, "px",
               "rounds stop when no image corner moves more than this under the new homography");
  table.number("min_tracks", min_tracks, 12, 4, 10000, "tracks",
               "fewer static tracks than this and the last homography is kept");
  table.number("reference_gap", reference_gap, 1, 1, 100, "frames",
               "frames between the reference and the target");
  table.flag(
      "follow_exposure", follow_exposure, true,
      "where the camera changed its exposure by more than 2 %, the compensated frame is made as bright as "
      "the other before they are compared; the paper says nothing of it");
}

}  // namespace stillpoint
