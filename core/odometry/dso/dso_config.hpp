#pragma once

#include "core/geometry/camera.hpp"
#include "core/parameter.hpp"

namespace stillpoint {

/// Constants of engine `dso`: Engel, Koltun & Cremers 2018, with depth from the sensor.
struct DsoConfig {
  static constexpr const char* kSection = "dso";
  DsoConfig() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const DsoConfig&) const = default;
  /// The same, with noise and limits of depth as a stereo pair has them.
  [[nodiscard]] DsoConfig for_camera(const Camera& camera) const;

  int levels;
  int candidates;
  int active_points;
  double gradient_margin;
  double gradient_softness;
  double huber;
  double outlier;
  double cutoff;
  double cutoff_share;
  double max_gain;
  double max_bias;
  double turn;
  double good_enough;
  double keyframe_shift;
  double keyframe_flow;
  double keyframe_gain;
  double keyframe_error;
  int window;
  int iterations;
  double least_left;
  double max_gain_step;
  int least_window;
  double depth_sigma;
  double noise;
  double farthest_m;
  int min_points;
};

}  // namespace stillpoint
