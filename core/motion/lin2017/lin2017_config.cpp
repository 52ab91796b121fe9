#include "core/motion/lin2017/lin2017_config.hpp"

namespace stillpoint {

void Lin2017Config::list(ParameterTable& table) {
  table.number("window_px", window_px, 15, 5, 51, "px",
               "side of the Lucas-Kanade window that follows features");
  table.number("levels", levels, 3, 0, 8, "", "pyramid levels above the image itself");
  table.number("forward_backward_px", forward_backward_px, 1.0, 0.05, 20, "px",
               "a feature followed there and back again may miss by so much");
  table.number("pixel_sigma_px", pixel_sigma_px, 0.5, 0.05, 10, "px",
               "standard deviation of where a feature is, in each of the two frames and directions");
  table.number("depth_sigma_per_m2", depth_sigma_per_m2, 1.425e-3, 1e-5, 0.1, "1/m",
               "a depth z has standard deviation this times z squared");
  table.number("depth_floor_m", depth_floor_m, 0.002, 0.0, 1.0, "m",
               "and a part that does not grow with depth");
  table.number("sigmas", sigmas, 3.0, 0.1, 100, "sigma",
               "scene flow shorter than so many of its own deviations is noise");
  table.number("least_flow_m", least_flow_m, 0.02, 0.0, 1.0, "m",
               "scene flow shorter than this is noise, too");
  table.number("azimuth_bins", azimuth_bins, 8, 1, 64, "",
               "classes of direction about the vertical; 8 = 45 degrees each");
  table.number("elevation_bins", elevation_bins, 4, 1, 32, "",
               "classes of direction up and down; 4 = 45 degrees each");
  table.number("neighbour_px", neighbour_px, 40.0, 1, 640, "px", "features this near are neighbours");
  table.number("like_neighbours", like_neighbours, 2, 0, 100, "features",
               "so many neighbours in the same class support a feature");
  table.number("least_features", least_features, 5, 1, 1000, "features",
               "a class with so many supported features is a thing that moves");
  table.number("virtual_frames", virtual_frames, 10, 0, 300, "frames",
               "so long a virtual map point outlives the last frame in which it moved; 0 = there are none");
  table.number("virtual_px", virtual_px, 20.0, 1, 200, "px",
               "a feature matches a virtual point this near its projection");
  table.number("virtual_hamming", virtual_hamming, 50, 0, 256, "bits",
               "and with so many unlike bits at most");
  table.number("rounds", rounds, 2, 1, 2, "",
               "before the second round the pose is solved again without what moves");
}

Lin2017Config Lin2017Config::for_camera(const Camera& camera) const {
  Lin2017Config fitted = *this;
  if (camera.is_stereo()) fitted.depth_sigma_per_m2 = camera.depth_sigma_per_m2;
  return fitted;
}

}  // namespace stillpoint
