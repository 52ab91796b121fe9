#include "core/odometry/ptam/ptam_config.hpp"

namespace stillpoint {

void PtamConfig::list(ParameterTable& table) {
  table.number("fast_0", fast_0, 10, 1, 200, "grey levels", "FAST threshold at full size");
  table.number("fast_1", fast_1, 15, 1, 200, "grey levels", "… at half size");
  table.number("fast_2", fast_2, 15, 1, 200, "grey levels", "… at a quarter");
  table.number("fast_3", fast_3, 10, 1, 200, "grey levels", "… at an eighth");
  table.number("velocity_decay", velocity_decay, 0.9, 0, 1, "",
               "times the mean of the measured and the last velocity is the next one");
  table.number("small_blur", small_blur, 0.75, 0.1, 10, "px",
               "of the small image that turns are found by, a sixteenth of the frame's sides");
  table.number("coarse_speed", coarse_speed, 0.006, 0, 10, "",
               "a coarse search comes first at so fast a motion: translation over depth, and rad, a frame");
  table.number("coarse_least", coarse_least, 20, 4, 1000, "points",
               "… with more points on the two top levels, and found");
  table.number("coarse_points", coarse_points, 60, 4, 1000, "points", "most of the coarse search");
  table.number("coarse_radius_px", coarse_radius_px, 30.0, 1, 200, "px", "of the coarse search");
  table.number("fine_points", fine_points, 1000, 20, 20000, "points", "most of the fine search");
  table.number("fine_radius_px", fine_radius_px, 10.0, 1, 200, "px", "of the fine search");
  table.number("fine_radius_after_coarse_px", fine_radius_after_coarse_px, 5.0, 1, 200, "px",
               "… after a coarse one");
  table.number("patch_limit", patch_limit, 500.0, 1, 65025, "grey levels²",
               "most squared difference a pixel of a patch that is found, means taken off");
  table.number("subpixel_steps", subpixel_steps, 8, 0, 50, "steps", "between pixels, in the coarse search");
  table.number("fine_subpixel_steps", fine_subpixel_steps, 0, 0, 50, "steps",
               "… and in the fine one; 0: whole pixels");
  table.number("iterations", iterations, 10, 1, 100, "steps", "of the pose, coarse and fine");
  table.number("prior", prior, 100.0, 0, 1e6, "",
               "information that holds the pose at its prediction, m and rad");
  table.number("quality_good", quality_good, 0.3, 0, 1, "", "tracking is good when this share is found");
  table.number("quality_bad", quality_bad, 0.13, 0, 1, "", "bad when of large patches less is");
  table.number("lost_after", lost_after, 3, 1, 1000, "frames", "so many bad ones running and it relocalises");
  table.number("min_found", min_found, 20, 6, 1000, "points", "with fewer found the frame is lost");
  table.number("keyframe_gap", keyframe_gap, 20, 0, 1000, "frames", "between keyframes, at least");
  table.number("keyframe_distance_m", keyframe_distance_m, 0.1, 0.001, 10, "m",
               "from the nearest keyframe, in a scene as deep as the first keyframe's");
  table.number("corner_limit", corner_limit, 70.0, 0, 10000, "", "least Shi-Tomasi score of a new point");
  table.number("apart_px", apart_px, 10, 1, 100, "px",
               "new points keep so far off others, in their level's pixels");
  table.number("new_points", new_points, 1000, 10, 20000, "points", "most a keyframe, a level");
  table.number("farthest_m", farthest_m, 8.0, 0.5, 100, "m", "farther depth makes no point");
  table.number("bundle_keyframes", bundle_keyframes, 4, 1, 50, "keyframes",
               "nearest the new one, adjusted with it");
  table.number("bundle_iterations", bundle_iterations, 20, 0, 200, "steps", "most of an adjustment");
  table.number("bundle_least_sigma_px", bundle_least_sigma_px, 0.4, 0.01, 10, "px",
               "least sigma of Tukey's bound there");
  table.number("bundle_depth_weight", bundle_depth_weight, 1.0, 0, 10, "",
               "weight of sensed depth in an adjustment, against pixels; 0: none");
  table.number("outlier_votes", outlier_votes, 20, 1, 10000, "votes",
               "a point with more, and more than inlier votes, is dropped");
}

PtamConfig PtamConfig::for_camera(const Camera& camera) const {
  PtamConfig fitted = *this;
  fitted.farthest_m = camera.depth_limit(farthest_m);
  return fitted;
}

}  // namespace stillpoint
