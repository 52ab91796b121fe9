#pragma once

#include "core/parameter.hpp"

namespace stillpoint {

/// METHOD.md §1: what is dynamic between two frames. Meanings, units and ranges: PaperConfig::list.
struct PaperConfig {
  static constexpr const char* kSection = "paper";
  PaperConfig() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const PaperConfig&) const = default;

  int max_corners;
  double corner_quality;
  double corner_distance_px;
  int flow_window_px;
  int flow_levels;
  double flow_max_residual;
  double ransac_threshold_px;
  double ransac_confidence;
  int ransac_iterations;
  int refine_iterations;
  int erode_kernel_px;
  int erode_iterations;
  int dilate_kernel_px;
  int dilate_iterations;
  int border_px;
  int max_rounds;
  double converged_shift_px;
  int min_tracks;
  int reference_gap;
  bool follow_exposure;
};

}  // namespace stillpoint
