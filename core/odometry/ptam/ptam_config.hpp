#pragma once

#include <array>

#include "core/geometry/camera.hpp"
#include "core/parameter.hpp"

namespace stillpoint {

/// Constants of engine `ptam`: Klein & Murray 2007, with depth from the sensor.
struct PtamConfig {
  static constexpr const char* kSection = "ptam";
  static constexpr int kLevels = 4;  // full size to an eighth, as Klein & Murray have it
  PtamConfig() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const PtamConfig&) const = default;
  /// The same, with noise and limits of depth as a stereo pair has them.
  [[nodiscard]] PtamConfig for_camera(const Camera& camera) const;

  int fast_0, fast_1, fast_2, fast_3;
  double velocity_decay;
  double small_blur;
  double coarse_speed;
  int coarse_least;
  int coarse_points;
  double coarse_radius_px;
  int fine_points;
  double fine_radius_px;
  double fine_radius_after_coarse_px;
  double patch_limit;
  int subpixel_steps;
  int fine_subpixel_steps;
  int iterations;
  double prior;
  double quality_good;
  double quality_bad;
  int lost_after;
  int min_found;
  int keyframe_gap;
  double keyframe_distance_m;
  double corner_limit;
  int apart_px;
  int new_points;
  double farthest_m;
  int bundle_keyframes;
  int bundle_iterations;
  double bundle_least_sigma_px;
  double bundle_depth_weight;
  int outlier_votes;

  [[nodiscard]] std::array<int, kLevels> fast() const { return {fast_0, fast_1, fast_2, fast_3}; }
};

}  // namespace stillpoint
