#pragma once

#include "core/geometry/camera.hpp"
#include "core/parameter.hpp"

namespace stillpoint {

/// Method `wang2014`: long point trajectories, clustered by their motion and spread over all pixels. Small
/// pixels are two full-size ones a side. Meanings, units and ranges: Wang2014Config::list.
struct Wang2014Config {
  static constexpr const char* kSection = "wang2014";
  Wang2014Config() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const Wang2014Config&) const = default;
  /// The same, with a stereo pair's noise of depth and limit where the camera is one.
  [[nodiscard]] Wang2014Config for_camera(const Camera& camera) const;

  int grid_px;
  int window_frames;
  double forward_backward_px;
  double forward_backward_share;
  int least_frames;
  int most_trajectories;
  double most_depth_m;
  double pixel_sigma_px;
  double depth_sigma_per_m2;
  double depth_floor_m;
  int velocity_frames;
  double half_speed;
  double half_distance_m;
  double noise_sigmas;
  int neighbours;
  double least_affinity;
  int eigenvectors;
  int least_clusters;
  int most_clusters;
  int ransac_samples;
  double merge_sigmas;
  double merge_share;
  int superpixel_px;
  double colour_scale;
  double place_scale_px;
  double depth_scale_m;
  int segment_frames;
  double row_x;
  double row_y;
};

}  // namespace stillpoint
