#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/parameter.hpp"

namespace stillpoint {

// Each section lists its constants' defaults, ranges, units and meanings in its list(), once.

/// ORB features spread over the image.
struct FeatureConfig {
  static constexpr const char* kSection = "features";
  FeatureConfig() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const FeatureConfig&) const = default;

  int count;
  int levels;
  double scale_factor;
  int fast_threshold;
  int fast_threshold_low;
};

/// Tracking against the local map.
struct TrackingConfig {
  static constexpr const char* kSection = "tracking";
  TrackingConfig() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const TrackingConfig&) const = default;

  double search_radius_px;
  double search_radius_wide_px;
  double map_radius_px;
  int match_max_distance;
  double match_ratio;
  int min_inliers;
  int min_initial_matches;
  int pnp_iterations;
  double pnp_threshold_px;
  int refine_iterations;
  int refine_rounds;
  bool adaptive_kernel;
  bool correct_rolling_shutter;
  bool correct_depth_lag;
  bool seek_consensus;
  double start_gate;
  bool soft_weights;
  double half_weight_log_odds;
  int smoother_lag_frames;
  double depth_weight;
};

/// Sparse direct alignment where corners starve, with methods that extend the odometry: the paper's has none.
struct DirectConfig {
  static constexpr const char* kSection = "direct";
  DirectConfig() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const DirectConfig&) const = default;

  int below_inliers;
  double below_share;
  int cell_px;
  int coarsest_level;
  int finest_level;
  int iterations;
  int min_patches;
  double min_correlation;
  double min_agreement;
  int max_age;
  double pixel_share;
};

/// The local map and its keyframes.
struct MapConfig {
  static constexpr const char* kSection = "map";
  MapConfig() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const MapConfig&) const = default;

  double far_depth_m;
  int min_new_points;
  int min_cell_points;
  int keyframe_max_gap;
  double keyframe_min_ratio;
  int keyframe_min_near;
  int keyframe_new_near;
  double cull_redundancy;
  double min_found_ratio;
  int max_local_keyframes;
  bool cull_dynamic;
  int max_keyframes;
};

/// Local bundle adjustment.
struct BundleConfig {
  static constexpr const char* kSection = "bundle";
  BundleConfig() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const BundleConfig&) const = default;

  int max_keyframes;
  int max_fixed_keyframes;
  int iterations;
};

struct RunConfig {
  static constexpr const char* kSection = "run";
  RunConfig() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const RunConfig&) const = default;

  std::string method;
  std::string odometry;
  int threads;
  int seed;
  bool check_removal;
};

/// Sections of constants whose types only their owners know: one a motion method or odometry engine that has
/// any. A value.
class OwnedSections {
 public:
  explicit OwnedSections(std::vector<AnySection> sections) : sections_(std::move(sections)) {}

  /// Null where none of its owners is registered.
  template <typename Section>
  [[nodiscard]] Section* find() {
    for (AnySection& section : sections_)
      if (Section* found = section.template as<Section>()) return found;
    return nullptr;
  }
  /// Adds every section's parameters.
  void list(std::vector<Parameter>& into);
  bool operator==(const OwnedSections&) const = default;

 private:
  std::vector<AnySection> sections_;  // in the order of the registry
};

/// Every registered motion method's section (core/motion/methods.hpp), at its defaults.
[[nodiscard]] OwnedSections method_sections();
/// Every registered odometry engine's (core/odometry/engines.hpp).
[[nodiscard]] OwnedSections engine_sections();

/// Every constant of a run.
struct Config {
  RunConfig run;
  OwnedSections methods = method_sections();
  OwnedSections engines = engine_sections();
  FeatureConfig features;
  TrackingConfig tracking;
  DirectConfig direct;
  MapConfig map;
  BundleConfig bundle;
  bool operator==(const Config&) const = default;

  /// A method's or an engine's own constants: `config.of<PaperConfig>().max_rounds`.
  /// @throws std::logic_error when nothing that is registered owns such a section
  template <typename Section>
  [[nodiscard]] Section& of() {
    if (Section* found = methods.find<Section>()) return *found;
    if (Section* found = engines.find<Section>()) return *found;
    throw std::logic_error(std::string("nothing registered owns the section [") + Section::kSection + "]");
  }
  template <typename Section>
  [[nodiscard]] const Section& of() const {
    return const_cast<Config*>(this)->of<Section>();
  }
};

/// All parameters of `config`, pointing into it, in the order they are written.
[[nodiscard]] std::vector<Parameter> parameters(Config& config);

/// Reads TOML over the defaults; keys not given keep their default.
/// @throws InputError with file and line: unreadable, not TOML, an unknown key, a wrong type or a value out
/// of range.
[[nodiscard]] Config read_config(const std::string& path);

/// The same of a text. @param path named in errors as where it stands
[[nodiscard]] Config config_from_toml(const std::string& text, const std::string& path);

/// Names of the presets there are, in alphabetical order.
[[nodiscard]] std::vector<std::string> preset_names();

/// A preset by name (`assets/presets/NAME.toml`), or a TOML file by path.
/// @throws InputError naming the presets there are.
[[nodiscard]] Config load_config(const std::string& preset_or_path);

/// Sets one `section.name=value`.
/// @throws InputError for an unknown key, a wrong type or a value out of range.
void set_parameter(Config& config, std::string_view assignment);

/// The config as TOML, every key with its unit and meaning as a comment; read_config reads it back to the
/// same.
[[nodiscard]] std::string to_toml(const Config& config);

}  // namespace stillpoint
