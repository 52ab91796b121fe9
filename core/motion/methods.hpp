#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "core/motion/figure_info.hpp"
#include "core/motion/motion_method.hpp"

namespace stillpoint {

/// Something a method can do without, and how it is told to.
struct Ingredient {
  std::string name;                      ///< for the command line and tables: "prior"
  std::string help;                      ///< what it does, a few words
  std::vector<std::string> assignments;  ///< `section.name=value`, as set_parameter takes them
};

/// What a method says of itself. Nothing outside core/motion knows a method by name.
struct MethodInfo {
  std::string name;      ///< the value of `--method`
  std::string title;     ///< for headings
  std::string summary;   ///< one sentence
  std::string citation;  ///< where it comes from; empty for none
  MotionNeeds needs{};
  bool baseline = false;   ///< removes nothing: what others are held against
  bool usual = false;      ///< among those compared when no methods are named
  bool reference = false;  ///< is given the ground truth: what removal could gain, not a method
  /// Judges features and makes no mask (MotionResult::weight_of_feature): its features are scored, and no
  /// mask.
  bool judges_features = false;
  /// Runs with what the odometry has beyond METHOD.md §2: direct alignment and fixed-lag re-estimation.
  bool extends_odometry = false;
  std::string without_depth{};  ///< the method that judges frames without depth; empty: nothing does
  AnySection parameters{};      ///< its own constants at their defaults; empty when it has none
  std::string old_section{};    ///< what its section was called before; read for one version more
  std::string partial_mask{};   ///< what MotionResult::partial_mask is: "forward_mask"; empty: it has none
  std::vector<FigureInfo> figures{};  ///< what MotionResult::figures holds
  std::vector<Ingredient> ingredients{};
  std::vector<std::string> panels{};  ///< panels that show its stages, most telling first; empty: "motion"
  std::unique_ptr<MotionMethod> (*make)(const Camera& camera, const Config& config) = nullptr;
};

/// The methods there are: those of methods.cpp, then those that were registered, in that order.
/// What is told of one stays where it is.
[[nodiscard]] const std::deque<MethodInfo>& methods();

[[nodiscard]] std::vector<std::string> method_names();

/// @throws InputError naming those there are
[[nodiscard]] const MethodInfo& method_named(const std::string& name);

/// The method that a config runs.
[[nodiscard]] const MethodInfo& method_of(const Config& config);

/// Names of those compared when none are named, the baseline first.
[[nodiscard]] std::vector<std::string> usual_methods();

/// The one that removes nothing.
[[nodiscard]] const MethodInfo& baseline_method();

/// The one that removes by masks made elsewhere and nothing of its own.
[[nodiscard]] const MethodInfo& outside_masks_method();

/// Adds a method to those there are: for programs that bring their own. Before the first Config is made.
/// @throws InputError when its name, or that of one of its figures, is taken
void register_method(MethodInfo method);

/// What runs when nothing else is asked for.
inline constexpr const char* kDefaultMethod = "stillpoint";

}  // namespace stillpoint
