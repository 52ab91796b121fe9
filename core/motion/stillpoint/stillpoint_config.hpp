#pragma once

#include "core/parameter.hpp"

namespace stillpoint {

/// Method `stillpoint`: what is dynamic where there is depth. Meanings, units and ranges:
/// StillpointConfig::list.
struct StillpointConfig {
  static constexpr const char* kSection = "stillpoint";
  StillpointConfig() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const StillpointConfig&) const = default;

  int factor;
  bool use_depth;
  bool use_brightness;
  int near_reference;
  int far_reference;
  int slow_reference;
  double depth_sigmas;
  double intensity_sigmas;
  double gradient_share;
  double max_registration_error_px;
  double prior_share;
  double max_log_odds;
  double confident_log_odds;
  double hysteresis;
  bool find_axial_motion;
  bool label_propagation;
  double superpixel_share;
  int superpixel_px;
  double smoothing;
  double moving_log_odds;
  double min_area_share;
  int margin_px;
};

}  // namespace stillpoint
