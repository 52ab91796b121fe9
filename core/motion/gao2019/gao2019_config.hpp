#pragma once

#include <string>

#include "core/motion/yi2013/yi2013_config.hpp"
#include "core/parameter.hpp"

namespace stillpoint {

/// Method `gao2019`: a background model of Gaussians a block, warped by pose and depth.
/// Meanings, units and ranges: Gao2019Config::list.
struct Gao2019Config {
  static constexpr const char* kSection = "gao2019";
  Gao2019Config() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const Gao2019Config&) const = default;

  /// The constants of method 7 that the block model and the grid flow go by: those below where they are named
  /// here, and its own defaults otherwise.
  [[nodiscard]] Yi2013Config model() const;

  std::string first_pose;
  int cell_px;
  int fast_threshold;
  int coarsest_level;
  int finest_level;
  int iterations;
  int min_patches;
  int median_radius_px;
  int block_px;
  double initial_sigma;
  double least_sigma;
  double max_age;
  double decay;
  double decay_above_sigma;
  bool follow_exposure;
  bool second_model;
  double match_limit;
  double moving_limit;
  double settled_age;
  bool drop_isolated;
  int fill_neighbours;
};

}  // namespace stillpoint
