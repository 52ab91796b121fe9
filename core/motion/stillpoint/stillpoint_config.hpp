#pragma once

#include "core/parameter.hpp"

namespace stillpoint {

/// Method `stillpoint`: what moves where there is depth. Meanings, units and ranges: StillpointConfig::list.
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
  double max_misplacement_px;
  double memory;
  double max_log_odds;
  double firm_log_odds;
  double release;
  bool find_receding;
  bool inherit;
  double patch_share;
  int segment_px;
  double smoothing;
  double moving_log_odds;
  double min_area_share;
  int margin_px;
};

}  // namespace stillpoint
