#pragma once

#include "core/parameter.hpp"

namespace stillpoint {

/// Method `yi2013`: a background model of two Gaussians a block, warped along with the camera by a
/// homography. Yi, Yun, Kim, Chang, Choi: "Detection of moving objects with non-stationary cameras in 5.8
/// ms", CVPRW 2013. yi2013.md beside this file has the equations. Meanings, units and ranges:
/// Yi2013Config::list.
struct Yi2013Config {
  static constexpr const char* kSection = "yi2013";
  Yi2013Config() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const Yi2013Config&) const = default;

  int median_radius_px;
  int cell_width_px;
  int cell_height_px;
  int window_px;
  int levels;
  int iterations;
  double epsilon_px;
  int min_tracks;
  double ransac_px;
  int block_px;
  double initial_sigma;
  double least_sigma;
  double max_age;
  double decay;
  double decay_above_sigma;
  double match_limit;
  double moving_limit;
  double settled_age;
};

}  // namespace stillpoint
