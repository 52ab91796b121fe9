#pragma once

#include "core/geometry/camera.hpp"
#include "core/motion/dai2020/point_graph.hpp"
#include "core/parameter.hpp"

namespace stillpoint {

/// Method `peng2017`: distances of neighbouring features between two frames; a feature is static when most of
/// its edges hold. Meanings, units and ranges: Peng2017Config::list.
struct Peng2017Config {
  static constexpr const char* kSection = "peng2017";
  Peng2017Config() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const Peng2017Config&) const = default;
  /// The same, with a stereo pair's noise of depth where the camera is one.
  [[nodiscard]] Peng2017Config for_camera(const Camera& camera) const;

  [[nodiscard]] FollowRule follow() const { return {window_px, levels, forward_backward_px}; }
  [[nodiscard]] EdgeRule edges() const { return {most_edge_m, most_step_m, least_dropped_px}; }

  int window_px;
  int levels;
  double forward_backward_px;
  double pixel_sigma_px;
  double depth_sigma_per_m2;
  double depth_floor_m;
  double spacing_px;
  double most_edge_m;
  double most_step_m;
  double least_dropped_px;
  double cut_sigmas;
  double held_share;
  double reach_px;
};

}  // namespace stillpoint
