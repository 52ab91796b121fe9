#pragma once

#include "core/geometry/camera.hpp"
#include "core/parameter.hpp"

namespace stillpoint {

/// Method `alcantarilla2012`: dense scene flow tested against its covariance. Small pixels are two full-size
/// ones a side. Meanings, units and ranges: Alcantarilla2012Config::list.
struct Alcantarilla2012Config {
  static constexpr const char* kSection = "alcantarilla2012";
  Alcantarilla2012Config() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const Alcantarilla2012Config&) const = default;
  /// The same, with noise and limits of depth as a stereo pair has them.
  [[nodiscard]] Alcantarilla2012Config for_camera(const Camera& camera) const;

  double flow_sigma_px;
  double depth_sigma_per_m2;
  double depth_floor_m;
  double least_depth_m;
  double most_depth_m;
  double forward_backward_px;
  double chi_squared;
  int vote_px;
  double vote_share;
  double most_moving;
  double most_contradicted;
  int rounds;
};

}  // namespace stillpoint
