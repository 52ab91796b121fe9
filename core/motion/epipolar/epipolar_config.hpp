#pragma once

#include "core/parameter.hpp"

namespace stillpoint {

/// Method `epipolar`: what is dynamic where there is colour alone. Small pixels are two full-size ones a
/// side. Meanings, units and ranges: EpipolarConfig::list.
struct EpipolarConfig {
  static constexpr const char* kSection = "epipolar";
  EpipolarConfig() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const EpipolarConfig&) const = default;

  int cell_px;
  int flow_window_px;
  double corner_response;
  int near_reference;
  int far_reference;
  double sigmas;
  double evidence_per_sigma;
  double prior_share;
  double max_evidence;
  double max_static_evidence;
  int close_px;
  int shave_px;
  int min_age;
  double same_motion_px;
  double smoothing;
  double colour_cost;
  double max_geodesic_distance;
  double moving_evidence;
  double min_area_share;
  int min_points;
};

}  // namespace stillpoint
