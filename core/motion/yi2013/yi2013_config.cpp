#include "core/motion/yi2013/yi2013_config.hpp"

namespace stillpoint {

void Yi2013Config::list(ParameterTable& table) {
  table.number("median_radius_px", median_radius_px, 2, 0, 10, "px",
               "radius of the median filter before all else; 2 = 5x5");
  table.number("cell_width_px", cell_width_px, 32, 4, 256, "px", "a cell this wide holds one followed point");
  table.number("cell_height_px", cell_height_px, 24, 4, 256, "px", "height of such a cell");
  table.number("window_px", window_px, 10, 3, 51, "px", "side of the Lucas-Kanade window");
  table.number("levels", levels, 3, 0, 8, "", "pyramid levels above the image itself");
  table.number("iterations", iterations, 20, 1, 100, "", "Lucas-Kanade steps a level, at most");
  table.number("epsilon_px", epsilon_px, 0.03, 1e-4, 1, "px", "a shorter Lucas-Kanade step is the last one");
  table.number("min_tracks", min_tracks, 10, 4, 10000, "points",
               "with fewer followed points the camera is taken to be static");
  table.number("ransac_px", ransac_px, 1.0, 0.05, 20, "px", "inliers lie this close to the homography");
  table.number("block_px", block_px, 4, 1, 32, "px", "side of a block of the background model");
  table.number("initial_sigma", initial_sigma, 20.0, 1, 128, "grey levels",
               "standard deviation of a Gaussian that begins");
  table.number("least_sigma", least_sigma, 5.0, 0.5, 128, "grey levels",
               "a Gaussian's standard deviation is at least this");
  table.number("max_age", max_age, 30.0, 2, 1000, "frames", "so many frames a Gaussian stands for, at most");
  table.number("decay", decay, 0.001, 0, 1, "per squared grey level",
               "how fast age falls where warping mixes unlike blocks");
  table.number("decay_above_sigma", decay_above_sigma, 50.0, 0, 255, "grey levels",
               "standard deviation above which age falls");
  table.number("match_limit", match_limit, 2.0, 0.1, 100, "",
               "a block belongs to a Gaussian up to this many variances from its mean, squared");
  table.number("moving_limit", moving_limit, 4.0, 0.1, 100, "",
               "a pixel is dynamic beyond so many variances from the apparent mean, squared");
  table.number("settled_age", settled_age, 1.0, 0, 1000, "frames",
               "an apparent Gaussian up to this age judges no pixel");
}

}  // namespace stillpoint
