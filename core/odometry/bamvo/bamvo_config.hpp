#pragma once

#include "core/geometry/camera.hpp"
#include "core/parameter.hpp"

namespace stillpoint {

/// Constants of engine `bamvo`: Kim & Kim 2016.
struct BamvoConfig {
  static constexpr const char* kSection = "bamvo";
  BamvoConfig() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const BamvoConfig&) const = default;
  /// The same, with noise and limits of depth as a stereo pair has them.
  [[nodiscard]] BamvoConfig for_camera(const Camera& camera) const;

  int image_factor;
  int history;
  double nearest_m;
  double farthest_m;
  double least_sigma_m;
  bool weigh_by_depth;
  int bilateral_px;
  double bilateral_sigma;
  double foreground_change_m;
  int iterations;
  double max_depth_difference_m;
  double student_freedom;
  double max_motion;
  int min_pixels;
  int patience;
};

}  // namespace stillpoint
