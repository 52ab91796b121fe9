#include "core/config.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "core/assets.hpp"
#include "core/error.hpp"
#include "core/motion/methods.hpp"
#include "core/odometry/engines.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

std::string in_range(const Parameter& p) {
  const std::string unit = p.unit.empty() ? "" : " " + p.unit;
  return fmt::format("from {} to {}{}", p.min, p.max, unit);
}

void check_range(const Parameter& p, double value, const std::string& where) {
  if (!(value >= p.min && value <= p.max))
    throw InputError(
        fmt::format("{}{} = {} is out of range: it takes a number {}", where, p.key, value, in_range(p)));
}

/// Stores a TOML value in the parameter. `where` opens every complaint.
void assign(const Parameter& p, const toml::node& node, const std::string& where) {
  if (auto* flag = std::get_if<bool*>(&p.value)) {
    // Files of earlier versions have 0 and 1.
    const auto value = node.value_exact<bool>();
    const auto number = node.value_exact<std::int64_t>();
    if (!value && number != 0 && number != 1)
      throw InputError(fmt::format("{}{} takes true or false", where, p.key));
    **flag = value ? *value : *number == 1;
  } else if (auto* integer = std::get_if<int*>(&p.value)) {
    const auto value = node.value_exact<std::int64_t>();
    if (!value) throw InputError(fmt::format("{}{} takes a whole number {}", where, p.key, in_range(p)));
    check_range(p, static_cast<double>(*value), where);
    **integer = static_cast<int>(*value);
  } else if (auto* real = std::get_if<double*>(&p.value)) {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value) throw InputError(fmt::format("{}{} takes a number {}", where, p.key, in_range(p)));
    check_range(p, *value, where);
    **real = *value;
  } else {
    const auto value = node.value_exact<std::string>();
    if (!p.choices.empty() &&
        (!value || std::find(p.choices.begin(), p.choices.end(), *value) == p.choices.end()))
      throw InputError(fmt::format("{}{} takes one of: {}{}", where, p.key, fmt::join(p.choices, ", "),
                                   value ? ", and not " + in_quotes(*value) : ""));
    if (!value) throw InputError(fmt::format("{}{} takes a text", where, p.key));
    *std::get<std::string*>(p.value) = *value;
  }
}

/// A key as it is called now. Sections of earlier versions keep their names for one version.
std::string current_key(std::string_view key) {
  for (const MethodInfo& method : methods()) {
    const std::string& old = method.old_section;
    if (!old.empty() && key.size() > old.size() && key.starts_with(old) && key[old.size()] == '.')
      return method.parameters.name() + std::string(key.substr(old.size()));
  }
  return std::string(key);
}

/// Parameters that there are no more. Files that name them, settings of older runs above all, are still read.
bool is_retired(std::string_view key) {
  return key ==
         "bundle.apply_after_frames";  // adjustments took so long that they were solved beside tracking
}

/// The parameter of that key, under the name it was asked for by: complaints name what was written.
Parameter find_parameter(const std::vector<Parameter>& all, std::string_view wanted,
                         const std::string& where) {
  const std::string key = current_key(wanted);
  const auto it = std::find_if(all.begin(), all.end(), [&](const Parameter& p) {
    return p.key == key || std::find(p.old_keys.begin(), p.old_keys.end(), key) != p.old_keys.end();
  });
  if (it == all.end()) throw InputError(fmt::format("{}there is no parameter '{}'", where, wanted));
  Parameter found = *it;
  found.key = wanted;
  return found;
}

std::string toml_value(const Parameter& p) {
  if (const auto* flag = std::get_if<bool*>(&p.value)) return **flag ? "true" : "false";
  if (const auto* integer = std::get_if<int*>(&p.value)) return fmt::format("{}", **integer);
  if (const auto* text = std::get_if<std::string*>(&p.value)) {
    if (!p.choices.empty() || (*text)->empty()) return fmt::format("\"{}\"", **text);
    std::ostringstream quoted;
    quoted << toml::value<std::string>(**text);
    return quoted.str();
  }
  std::string number =
      fmt::format("{}", *std::get<double*>(p.value));  // shortest text that reads back the same
  if (number.find_first_of(".e") == std::string::npos) number += ".0";
  return number;
}

std::string line_prefix(const std::string& path, const toml::source_region& source) {
  return fmt::format("{}:{}: ", path, source.begin.line);
}

}  // namespace

void FeatureConfig::list(ParameterTable& table) {
  table.number("count", count, 1000, 50, 20000, "features", "ORB features wanted a frame");
  table.number("levels", levels, 8, 1, 12, "levels", "pyramid levels");
  table.number("scale_factor", scale_factor, 1.2, 1.05, 2, "", "scale from level to level");
  table.number("fast_threshold", fast_threshold, 20, 1, 200, "grey levels", "FAST threshold");
  table.number("fast_threshold_low", fast_threshold_low, 7, 1, 200, "grey levels",
               "FAST threshold where a cell has no corner otherwise");
}

void TrackingConfig::list(ParameterTable& table) {
  table.number("search_radius_px", search_radius_px, 15.0, 1, 200, "px",
               "matching window about the predicted pixel");
  table.number("search_radius_wide_px", search_radius_wide_px, 30.0, 1, 400, "px",
               "the same at the second attempt");
  table.number("map_radius_px", map_radius_px, 4.0, 0.5, 100, "px",
               "matching window of map points once the pose is known");
  table.number("match_max_distance", match_max_distance, 100, 1, 256, "bits",
               "largest distance of ORB descriptors");
  table.number("match_ratio", match_ratio, 0.8, 0.1, 1, "", "best over second-best distance");
  table.number("min_inliers", min_inliers, 20, 6, 1000, "matches", "fewer inliers and the frame is lost");
  table.number("min_initial_matches", min_initial_matches, 15, 6, 1000, "matches",
               "fewer and the motion model has failed");
  table.number("pnp_iterations", pnp_iterations, 200, 10, 10000, "samples", "RANSAC samples for EPnP");
  table.number("pnp_threshold_px", pnp_threshold_px, 4.0, 0.5, 50, "px", "inlier threshold for EPnP");
  table.number("refine_iterations", refine_iterations, 10, 1, 100, "steps",
               "Levenberg-Marquardt steps a round of eq. (5)");
  table.number("refine_rounds", refine_rounds, 4, 1, 10, "rounds",
               "rounds of eq. (5), outliers told apart again after each");
  table.flag("adaptive_kernel", adaptive_kernel, false,
             "a loss whose shape is taken from the residuals (Barron's) in place of Huber's");
  table.flag("correct_rolling_shutter", correct_rolling_shutter, true,
             "carries features to where their frame's middle row would show them");
  table.flag("correct_depth_lag", correct_depth_lag, true,
             "carries depth taken at another time than colour to colour's time");
  table.flag("seek_consensus", seek_consensus, true,
             "takes method stillpoint's first pose from where most samples agree");
  table
      .number("start_gate", start_gate, 2.0, 0, 1000, "",
              "matches off by more than so many chi-square bounds under the consensus do not begin the "
              "pose; 0 all do")
      .formerly("start_looseness");
  table.flag("soft_weights", soft_weights, true,
             "weighs each feature by how likely it is static, where method stillpoint left it in");
  table
      .number("half_weight_log_odds", half_weight_log_odds, -2.0, -10, 10, "",
              "log-odds of moving at which a feature counts half")
      .formerly("half_trust_log_odds");
  table
      .number("smoother_lag_frames", smoother_lag_frames, 60, 0, 1000, "frames",
              "methods stillpoint and oracle solve each pose once more, by the map so much later; 0 never")
      .formerly("look_back_frames");
  table.number("depth_weight", depth_weight, 1.0, 0, 10, "",
               "weight of the depth residual beside the paper's pixel residuals; 0 is the paper's eq. (5)");
}

void DirectConfig::list(ParameterTable& table) {
  table.number("below_inliers", below_inliers, 50, 0, 1000, "matches",
               "methods stillpoint and oracle align frames with fewer inliers directly too; 0 never any");
  table.number("below_share", below_share, 0.5, 0, 1, "",
               "… and those with fewer than this share of what was usual lately");
  table.number("cell_px", cell_px, 16, 8, 64, "px", "a cell of this side holds one patch");
  table.number("coarsest_level", coarsest_level, 4, 0, 6, "", "pyramid level at which alignment begins");
  table.number("finest_level", finest_level, 1, 0, 6, "", "pyramid level at which alignment ends");
  table.number("iterations", iterations, 10, 1, 100, "steps", "most Gauss-Newton steps a level");
  table.number("min_patches", min_patches, 80, 10, 5000, "patches",
               "with fewer in view no directly aligned pose is believed");
  table.number("min_correlation", min_correlation, 0.6, 0, 1, "",
               "least correlation of the patches' brightness with the frame's");
  table.number("min_agreement", min_agreement, 0.5, 0, 1, "",
               "least share of patches at whose place the expected depth is measured");
  table.number("max_age", max_age, 10, 1, 30, "frames", "how far back the frame aligned with may lie");
  table.number("pixel_share", pixel_share, 0.3, 0.0001, 1, "",
               "independent measurements a patch's pixel counts for when poses are fused");
}

void MapConfig::list(ParameterTable& table) {
  table.number(
      "far_depth_m", far_depth_m, 3.0, 0.1, 50, "m",
      "points are made from depth up to here, farther only when few are near; for a stereo pair as many "
      "baselines away as this is of a Kinect's");
  table.number("min_new_points", min_new_points, 100, 0, 5000, "points",
               "so many nearest points are made however far");
  table.number("min_cell_points", min_cell_points, 5, 0, 1000, "points",
               "so many points are made in each part of the image of 80 px however far");
  table.number("keyframe_max_gap", keyframe_max_gap, 30, 1, 1000, "frames",
               "after so many frames a keyframe may be made whatever else");
  table.number("keyframe_min_ratio", keyframe_min_ratio, 0.75, 0, 1, "",
               "a keyframe is made when inliers fall below this share of the reference's");
  table.number("keyframe_min_near", keyframe_min_near, 100, 0, 5000, "features",
               "or fewer near features than this are tracked");
  table.number("keyframe_new_near", keyframe_new_near, 70, 0, 5000, "features",
               "while so many near ones wait to become points");
  table.number("cull_redundancy", cull_redundancy, 0.9, 0.1, 1, "",
               "a keyframe is culled when this share of its points is seen by three others");
  table.number("min_found_ratio", min_found_ratio, 0.25, 0, 1, "",
               "a young point found in less than this share of its sightings is culled");
  table.number("max_local_keyframes", max_local_keyframes, 20, 1, 500, "keyframes",
               "covisible keyframes in the local map");
  table
      .flag("cull_dynamic", cull_dynamic, true,
            "takes points on what method stillpoint finds moving out of the map")
      .formerly("purge_moving");
  table.number("max_keyframes", max_keyframes, 100, 2, 10000, "keyframes", "beyond them the oldest retires");
}

void BundleConfig::list(ParameterTable& table) {
  table.number("max_keyframes", max_keyframes, 12, 1, 100, "keyframes", "local keyframes refined");
  table.number("max_fixed_keyframes", max_fixed_keyframes, 20, 1, 200, "keyframes",
               "keyframes that share their points, held fixed");
  table.number("iterations", iterations, 5, 1, 100, "steps", "most Levenberg-Marquardt steps");
}

void RunConfig::list(ParameterTable& table) {
  table.choice("method", method, kDefaultMethod, method_names(), "which method judges what moves");
  table.choice("odometry", odometry, kDefaultEngine, engine_names(),
               "which engine tells where the camera is, behind that method");
  table.number("threads", threads, 2, 1, 64, "threads", "worker threads; any number gives the same bytes");
  table.number("seed", seed, 1, 0, 1e9, "", "of generated sequences");
  table.flag(
      "check_removal", check_removal, false,
      "each pose is also solved without removal, and with the true mask where known; changes no result");
}

OwnedSections method_sections() {
  std::vector<AnySection> sections;
  for (const MethodInfo& method : methods())
    if (!method.parameters.empty()) sections.push_back(method.parameters);
  return OwnedSections(std::move(sections));
}

OwnedSections engine_sections() {
  std::vector<AnySection> sections;
  for (const EngineInfo& engine : engines())
    if (!engine.parameters.empty()) sections.push_back(engine.parameters);
  return OwnedSections(std::move(sections));
}

void OwnedSections::list(std::vector<Parameter>& into) {
  for (AnySection& section : sections_) section.list(into);
}

std::vector<Parameter> parameters(Config& config) {
  std::vector<Parameter> all;
  const auto add = [&all](auto& section) {
    ParameterTable table(section.kSection, all);
    section.list(table);
  };
  add(config.run);
  config.methods.list(all);
  config.engines.list(all);
  add(config.features);
  add(config.tracking);
  add(config.direct);
  add(config.map);
  add(config.bundle);
  return all;
}

Config read_config(const std::string& path) {
  std::error_code none;
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path, none))
    throw InputError(fmt::format("{}: the configuration cannot be read", path));
  return config_from_toml({std::istreambuf_iterator<char>(file), {}}, path);
}

Config config_from_toml(const std::string& text, const std::string& path) {
  toml::table table;
  try {
    table = toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    throw InputError(line_prefix(path, error.source()) +
                     "not valid TOML: " + std::string(error.description()));
  }

  Config config;
  std::vector<Parameter> all = parameters(config);
  for (auto&& [section, node] : table) {
    const std::string where = line_prefix(path, node.source());
    if (!node.is_table())
      throw InputError(fmt::format("{}'{}' stands outside a section such as [motion]", where, section.str()));
    for (auto&& [key, value] : *node.as_table()) {
      const std::string name = fmt::format("{}.{}", section.str(), key.str());
      if (is_retired(name)) continue;
      const std::string line = line_prefix(path, value.source());
      assign(find_parameter(all, name, line), value, line);
    }
  }
  return config;
}

std::vector<std::string> preset_names() {
  std::error_code none;
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(assets_folder() / "presets", none))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

Config load_config(const std::string& preset_or_path) {
  if (preset_or_path.ends_with(".toml")) return read_config(preset_or_path);
  const std::filesystem::path file = assets_folder() / "presets" / (preset_or_path + ".toml");
  std::error_code none;
  if (std::filesystem::exists(file, none)) return read_config(file.string());
  throw InputError(fmt::format("there is no preset '{}'; the presets are: {} (or give a .toml file)",
                               preset_or_path, fmt::join(preset_names(), ", ")));
}

void set_parameter(Config& config, std::string_view assignment) {
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos)
    throw InputError(fmt::format("'{}' is no assignment: write section.name=value", assignment));
  const std::string_view key = assignment.substr(0, equals), value = assignment.substr(equals + 1);
  std::vector<Parameter> all = parameters(config);
  const Parameter parameter = find_parameter(all, key, "");
  toml::table table;
  if (std::holds_alternative<std::string*>(parameter.value)) {
    table.insert("value", std::string(value));
  } else {
    try {
      table = toml::parse(fmt::format("value = {}", value));
    } catch (const toml::parse_error&) {
      table.clear();
    }
    if (table.size() != 1) throw InputError(fmt::format("'{}' is no value for {}", value, key));
  }
  assign(parameter, *table.get("value"), "");
}

std::string to_toml(const Config& config) {
  Config copy = config;
  std::string text, section;
  for (const Parameter& p : parameters(copy)) {
    const auto dot = p.key.find('.');
    if (p.key.substr(0, dot) != section) {
      section = p.key.substr(0, dot);
      text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", section);
    }
    const std::string unit = p.unit.empty() ? "" : fmt::format(" [{}]", p.unit);
    text += fmt::format("{} = {}  # {}{}\n", p.key.substr(dot + 1), toml_value(p), p.help, unit);
  }
  return text;
}

}  // namespace stillpoint
