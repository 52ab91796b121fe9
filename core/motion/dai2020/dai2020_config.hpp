#pragma once

#include <string>

#include "core/geometry/camera.hpp"
#include "core/motion/dai2020/point_graph.hpp"
#include "core/parameter.hpp"

namespace stillpoint {

/// Method `dai2020`: a graph of points whose edges remember their lengths; the largest group that holds
/// together is static. Meanings, units and ranges: Dai2020Config::list.
struct Dai2020Config {
  static constexpr const char* kSection = "dai2020";
  Dai2020Config() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const Dai2020Config&) const = default;
  /// The same, with a stereo pair's noise of depth where the camera is one.
  [[nodiscard]] Dai2020Config for_camera(const Camera& camera) const;

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
  int keyframe_frames;
  double cut_sigmas;
  int cut_count;
  int cut_window;
  double mend_sigmas;
  int mend_frames;
  int settle_frames;
  int least_group;
  std::string group_by;
  double reach_px;
};

}  // namespace stillpoint
