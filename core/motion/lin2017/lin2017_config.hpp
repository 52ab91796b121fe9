#pragma once

#include "core/geometry/camera.hpp"
#include "core/parameter.hpp"

namespace stillpoint {

/// Method `lin2017`: scene flow of features sorted by its direction, and virtual map points of what moved.
/// Meanings, units and ranges: Lin2017Config::list.
struct Lin2017Config {
  static constexpr const char* kSection = "lin2017";
  Lin2017Config() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const Lin2017Config&) const = default;
  /// The same, with noise and limits of depth as a stereo pair has them.
  [[nodiscard]] Lin2017Config for_camera(const Camera& camera) const;

  int window_px;
  int levels;
  double forward_backward_px;
  double pixel_sigma_px;
  double depth_sigma_per_m2;
  double depth_floor_m;
  double sigmas;
  double least_flow_m;
  int azimuth_bins;
  int elevation_bins;
  double neighbour_px;
  int like_neighbours;
  int least_features;
  int virtual_frames;
  double virtual_px;
  int virtual_hamming;
  int rounds;
};

}  // namespace stillpoint
