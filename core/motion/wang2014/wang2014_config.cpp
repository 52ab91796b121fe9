#include "core/motion/wang2014/wang2014_config.hpp"

namespace stillpoint {

void Wang2014Config::list(ParameterTable& table) {
  table.number("grid_px", grid_px, 8, 2, 64, "px", "side of the cells each of which begins a trajectory");
  table.number("window_frames", window_frames, 10, 2, 60, "frames", "trajectories are looked back at so far");
  table.number("forward_backward_px", forward_backward_px, 1.0, 0.05, 20, "px",
               "flow there and back again may miss by so much, ...");
  table.number("forward_backward_share", forward_backward_share, 0.05, 0.0, 1.0, "",
               "... and by this share of its length");
  table.number("least_frames", least_frames, 6, 2, 60, "frames",
               "trajectories measured in fewer are not clustered");
  table.number("most_trajectories", most_trajectories, 400, 20, 2000, "",
               "so many are clustered at most, evenly chosen");
  table.number("most_depth_m", most_depth_m, 5.0, 0.5, 100, "m", "farther points are not clustered");
  table.number("pixel_sigma_px", pixel_sigma_px, 1.0, 0.05, 10, "px",
               "standard deviation of where a point is, in each direction");
  table.number("depth_sigma_per_m2", depth_sigma_per_m2, 1.425e-3, 1e-5, 0.1, "1/m",
               "a depth z has standard deviation this times z squared");
  table.number("depth_floor_m", depth_floor_m, 0.002, 0.0, 1.0, "m",
               "and a part that does not grow with depth");
  table.number("velocity_frames", velocity_frames, 5, 1, 30, "frames", "velocities are taken over so many");
  table.number("half_speed", half_speed, 0.05, 1e-4, 10, "m/s",
               "affinity is a half at this difference of velocity ...");
  table.number("half_distance_m", half_distance_m, 0.3, 1e-3, 10, "m", "... between points so far apart");
  table.number("noise_sigmas", noise_sigmas, 3.0, 0.0, 10, "sigma",
               "a difference of velocity counts as far as it exceeds so many deviations of its noise");
  table.number("neighbours", neighbours, 12, 1, 100, "", "nearest trajectories that one is compared with");
  table.number("least_affinity", least_affinity, 0.001, 0.0, 1.0, "",
               "affinity of neighbours at least: keeps the graph in one piece");
  table.number("eigenvectors", eigenvectors, 8, 3, 20, "",
               "of the normalised Laplacian, those that are looked at");
  table.number("least_clusters", least_clusters, 2, 1, 20, "", "clusters, at least ...");
  table.number("most_clusters", most_clusters, 6, 1, 20, "", "... and at most; the largest eigengap decides");
  table.number("ransac_samples", ransac_samples, 100, 1, 10000, "", "of three points for a rigid motion");
  table.number("merge_sigmas", merge_sigmas, 3.0, 0.1, 100, "sigma",
               "a rigid motion explains a point that it brings so near");
  table.number("merge_share", merge_share, 0.5, 0.0, 1.0, "",
               "clusters are one when each one's motion explains more than this share of the other's points");
  table.number("superpixel_px", superpixel_px, 7, 4, 100, "small px",
               "side of a superpixel; 7 = about 200 px");
  table.number("colour_scale", colour_scale, 30.0, 0.1, 255, "grey levels",
               "a difference in brightness that counts as one");
  table.number("place_scale_px", place_scale_px, 20.0, 0.1, 1000, "px", "a distance that counts as one");
  table.number("depth_scale_m", depth_scale_m, 0.1, 0.001, 100, "m",
               "a difference in depth that counts as one");
  table.number("segment_frames", segment_frames, 5, 1, 100, "frames",
               "every so many frames are segmented; flow carries the mask between");
  table.number("row_x", row_x, 0.5, 0.0, 1.0, "",
               "affinities are shown of the trajectory nearest to this place, from the left ...");
  table.number("row_y", row_y, 0.5, 0.0, 1.0, "", "... and from the top; for display alone");
}

Wang2014Config Wang2014Config::for_camera(const Camera& camera) const {
  Wang2014Config fitted = *this;
  if (camera.is_stereo()) fitted.depth_sigma_per_m2 = camera.depth_sigma_per_m2;
  fitted.most_depth_m = camera.depth_limit(most_depth_m);
  return fitted;
}

}  // namespace stillpoint
