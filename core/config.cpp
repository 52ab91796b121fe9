#include "core/config.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/assets.hpp"
#include "core/error.hpp"

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
void assign(Parameter& p, const toml::node& node, const std::string& where) {
  if (auto* integer = std::get_if<int*>(&p.value)) {
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
    if (!value || std::find(p.choices.begin(), p.choices.end(), *value) == p.choices.end())
      throw InputError(fmt::format("{}{} takes one of: {}", where, p.key, fmt::join(p.choices, ", ")));
    *std::get<std::string*>(p.value) = *value;
  }
}

Parameter& find_parameter(std::vector<Parameter>& all, std::string_view key, const std::string& where) {
  const auto it = std::find_if(all.begin(), all.end(), [&](const Parameter& p) { return p.key == key; });
  if (it == all.end()) throw InputError(fmt::format("{}there is no parameter '{}'", where, key));
  return *it;
}

std::string toml_value(const Parameter& p) {
  if (const auto* integer = std::get_if<int*>(&p.value)) return fmt::format("{}", **integer);
  if (const auto* text = std::get_if<std::string*>(&p.value)) return fmt::format("\"{}\"", **text);
  std::string number =
      fmt::format("{}", *std::get<double*>(p.value));  // shortest text that reads back the same
  if (number.find_first_of(".e") == std::string::npos) number += ".0";
  return number;
}

std::string line_prefix(const std::string& path, const toml::source_region& source) {
  return fmt::format("{}:{}: ", path, source.begin.line);
}

}  // namespace

std::vector<Parameter> parameters(Config& c) {
  std::vector<Parameter> all;
  const auto number = [&](const char* key, auto* value, double min, double max, const char* unit,
                          const char* help) {
    all.push_back({key, value, min, max, {}, unit, help});
  };

  all.push_back({"run.method",
                 &c.run.method,
                 0,
                 0,
                 {"stillpoint", "paper", "none", "oracle"},
                 "",
                 "what is removed: what depth and memory show moving, what the paper finds, nothing, or what "
                 "the true masks say (a reference)"});
  number("run.threads", &c.run.threads, 1, 64, "threads", "worker threads; any number gives the same bytes");
  number("run.seed", &c.run.seed, 0, 1e9, "", "of generated sequences");
  number(
      "run.check_removal", &c.run.check_removal, 0, 1, "",
      "1: each pose is also solved without removal, and with the true mask where known; changes no result");

  MotionConfig& m = c.motion;
  number("motion.max_corners", &m.max_corners, 16, 20000, "corners", "corners followed per direction");
  number("motion.corner_quality", &m.corner_quality, 1e-5, 1, "",
         "least corner response, as a share of the best corner's");
  number("motion.corner_distance_px", &m.corner_distance_px, 1, 100, "px", "least distance between corners");
  number("motion.flow_window_px", &m.flow_window_px, 5, 101, "px", "side of the Lucas-Kanade window");
  number("motion.flow_levels", &m.flow_levels, 0, 8, "levels", "pyramid levels above the full image");
  number("motion.flow_max_residual", &m.flow_max_residual, 0.1, 255, "grey levels",
         "mean absolute residual above which a track is dropped");
  number("motion.ransac_threshold_px", &m.ransac_threshold_px, 0.1, 50, "px",
         "reprojection error that makes a track an inlier of the homography");
  number("motion.ransac_confidence", &m.ransac_confidence, 0.5, 0.999999, "",
         "probability that RANSAC drew one outlier-free sample");
  number("motion.ransac_iterations", &m.ransac_iterations, 10, 100000, "samples",
         "most samples RANSAC draws");
  number("motion.refine_iterations", &m.refine_iterations, 0, 200, "steps",
         "most Levenberg-Marquardt steps on eq. (4)");
  number("motion.erode_kernel_px", &m.erode_kernel_px, 1, 99, "px", "side of the square erosion kernel");
  number("motion.erode_iterations", &m.erode_iterations, 0, 20, "times", "how often the erosion is applied");
  number("motion.dilate_kernel_px", &m.dilate_kernel_px, 1, 99, "px", "side of the square dilation kernel");
  number("motion.dilate_iterations", &m.dilate_iterations, 0, 20, "times",
         "how often the dilation is applied");
  number("motion.border_px", &m.border_px, 0, 200, "px",
         "margin beside the warp's border that counts as having no data");
  number("motion.max_rounds", &m.max_rounds, 1, 20, "rounds", "rounds of removal and a better homography");
  number("motion.converged_shift_px", &m.converged_shift_px, 0, 10, "px",
         "rounds stop when no image corner moves more than this under the new homography");
  number("motion.min_tracks", &m.min_tracks, 4, 10000, "tracks",
         "fewer static tracks than this and the last homography is kept");
  number("motion.reference_gap", &m.reference_gap, 1, 100, "frames",
         "frames between the reference and the target");

  DepthMotionConfig& d = c.depth_motion;
  number("depth_motion.factor", &d.factor, 1, 16, "px",
         "side of the block of pixels in which motion is judged");
  number("depth_motion.use_depth", &d.use_depth, 0, 1, "", "1 takes depth residuals for evidence");
  number("depth_motion.use_brightness", &d.use_brightness, 0, 1, "",
         "1 takes brightness residuals for evidence");
  number("depth_motion.near_reference", &d.near_reference, 1, 30, "frames",
         "how far back the nearer reference lies");
  number("depth_motion.far_reference", &d.far_reference, 1, 100, "frames",
         "how far back the far reference lies, of frames with an even index");
  number("depth_motion.slow_reference", &d.slow_reference, 1, 100, "frames",
         "how far back the far reference lies, of frames with an odd index: for slow movers");
  number("depth_motion.depth_sigmas", &d.depth_sigmas, 1, 50, "sigma",
         "depth residual beyond which a pixel counts as moved");
  number("depth_motion.intensity_sigmas", &d.intensity_sigmas, 1, 50, "sigma",
         "brightness residual beyond which a pixel counts as moved");
  number("depth_motion.gradient_share", &d.gradient_share, 0, 5, "",
         "share of the local gradient a brightness residual may reach");
  number("depth_motion.max_misplacement_px", &d.max_misplacement_px, 0, 5, "px",
         "most that surfaces are taken to lie beside their place, in small pixels");
  number("depth_motion.memory", &d.memory, 0, 1, "", "share of the log-odds carried to the next frame");
  number("depth_motion.max_log_odds", &d.max_log_odds, 0.5, 100, "", "where evidence saturates");
  number("depth_motion.firm_log_odds", &d.firm_log_odds, 0, 100, "",
         "above it a pixel is firmly known to move");
  number("depth_motion.release", &d.release, 0, 1, "",
         "share of evidence for standing still that what firmly moves takes");
  number("depth_motion.find_receding", &d.find_receding, 0, 1, "",
         "1 looks for patches that go back, away from the camera");
  number("depth_motion.inherit", &d.inherit, 0, 1, "",
         "1 lets what comes into view take over what its surface is known to do");
  number("depth_motion.patch_share", &d.patch_share, 0, 1, "",
         "share of the log-odds by a patch's shift that counts in one frame");
  number("depth_motion.segment_px", &d.segment_px, 4, 100, "px", "side of a surface patch, in blocks");
  number("depth_motion.smoothing", &d.smoothing, 0, 100, "",
         "weight of neighbours on the same surface against a patch's own evidence");
  number("depth_motion.moving_log_odds", &d.moving_log_odds, 0.01, 10, "",
         "log-odds above which a patch moves");
  number("depth_motion.min_area_share", &d.min_area_share, 0, 0.5, "",
         "share of the image below which a region is noise");
  number("depth_motion.margin_px", &d.margin_px, 0, 50, "px", "added about the mask at the end");

  ColourMotionConfig& u = c.colour_motion;
  number("colour_motion.cell_px", &u.cell_px, 4, 64, "small px",
         "a cell of this side holds one followed point");
  number("colour_motion.flow_window_px", &u.flow_window_px, 5, 51, "small px",
         "side of the Lucas-Kanade window");
  number("colour_motion.corner_response", &u.corner_response, 1e-6, 1, "",
         "least eigenvalue of the gradient matrix that makes a point");
  number("colour_motion.near_reference", &u.near_reference, 1, 30, "frames",
         "how far back the nearest of three references lies");
  number("colour_motion.far_reference", &u.far_reference, 1, 60, "frames",
         "how far back the farthest reference lies");
  number("colour_motion.sigmas", &u.sigmas, 0.5, 20, "sigma", "residual at which evidence changes sign");
  number("colour_motion.evidence_a_sigma", &u.evidence_a_sigma, 0.01, 10, "",
         "evidence for every standard deviation beyond that");
  number("colour_motion.memory", &u.memory, 0, 1, "",
         "share of a point's evidence carried to the next frame");
  number("colour_motion.max_evidence", &u.max_evidence, 0.5, 100, "", "where evidence saturates");
  number("colour_motion.max_static_evidence", &u.max_static_evidence, 0, 100, "",
         "where evidence of standing still saturates");
  number("colour_motion.close_px", &u.close_px, 0, 50, "quarter px",
         "gaps in the mask up to twice this are closed");
  number("colour_motion.shave_px", &u.shave_px, 0, 20, "quarter px",
         "so far within its outline the mask goes with its colours");
  number("colour_motion.min_age", &u.min_age, 1, 60, "frames",
         "so long a point is followed before it has a say");
  number("colour_motion.same_motion_px", &u.same_motion_px, 0.05, 20, "small px",
         "difference of two points' paths that sets them apart");
  number("colour_motion.sharing", &u.sharing, 0, 100, "",
         "weight of a neighbour that moves alike against a point's own evidence");
  number("colour_motion.colour_price", &u.colour_price, 0, 10, "quarter px",
         "what a grey level of change costs evidence on its way");
  number("colour_motion.longest_way", &u.longest_way, 1, 1000, "quarter px", "way over which evidence ends");
  number("colour_motion.moving_evidence", &u.moving_evidence, 0.01, 10, "",
         "evidence above which a pixel moves");
  number("colour_motion.min_area_share", &u.min_area_share, 0, 0.5, "",
         "share of the image below which a region is noise");
  number("colour_motion.min_points", &u.min_points, 1, 1000, "points",
         "a region with fewer moving points is noise");

  FeatureConfig& f = c.features;
  number("features.count", &f.count, 50, 20000, "features", "ORB features wanted a frame");
  number("features.levels", &f.levels, 1, 12, "levels", "pyramid levels");
  number("features.scale_factor", &f.scale_factor, 1.05, 2, "", "scale from level to level");
  number("features.fast_threshold", &f.fast_threshold, 1, 200, "grey levels", "FAST threshold");
  number("features.fast_threshold_low", &f.fast_threshold_low, 1, 200, "grey levels",
         "FAST threshold where a cell has no corner otherwise");

  TrackingConfig& t = c.tracking;
  number("tracking.search_radius_px", &t.search_radius_px, 1, 200, "px",
         "matching window about the predicted pixel");
  number("tracking.search_radius_wide_px", &t.search_radius_wide_px, 1, 400, "px",
         "the same at the second attempt");
  number("tracking.map_radius_px", &t.map_radius_px, 0.5, 100, "px",
         "matching window of map points once the pose is known");
  number("tracking.match_max_distance", &t.match_max_distance, 1, 256, "bits",
         "largest distance of ORB descriptors");
  number("tracking.match_ratio", &t.match_ratio, 0.1, 1, "", "best over second-best distance");
  number("tracking.min_inliers", &t.min_inliers, 6, 1000, "matches", "fewer inliers and the frame is lost");
  number("tracking.min_initial_matches", &t.min_initial_matches, 6, 1000, "matches",
         "fewer and the motion model has failed");
  number("tracking.pnp_iterations", &t.pnp_iterations, 10, 10000, "samples", "RANSAC samples for EPnP");
  number("tracking.pnp_threshold_px", &t.pnp_threshold_px, 0.5, 50, "px", "inlier threshold for EPnP");
  number("tracking.refine_iterations", &t.refine_iterations, 1, 100, "steps",
         "Levenberg-Marquardt steps a round of eq. (5)");
  number("tracking.refine_rounds", &t.refine_rounds, 1, 10, "rounds",
         "rounds of eq. (5), outliers told apart again after each");
  number("tracking.correct_rolling_shutter", &t.correct_rolling_shutter, 0, 1, "",
         "1 carries features to where their frame's middle row would show them");
  number("tracking.correct_depth_lag", &t.correct_depth_lag, 0, 1, "",
         "1 carries depth taken at another time than colour to colour's time");
  number("tracking.seek_consensus", &t.seek_consensus, 0, 1, "",
         "1 takes method stillpoint's first pose from where most samples agree");
  number("tracking.start_looseness", &t.start_looseness, 0, 1000, "",
         "matches off by more than so many chi-square bounds under the consensus do not begin the pose; 0 "
         "all do");
  number("tracking.soft_weights", &t.soft_weights, 0, 1, "",
         "1 weighs each feature by how likely it stands still, where method stillpoint left it in");
  number("tracking.half_trust_log_odds", &t.half_trust_log_odds, -10, 10, "",
         "log-odds of moving at which a feature counts half");
  number("tracking.look_back_frames", &t.look_back_frames, 0, 1000, "frames",
         "methods stillpoint and oracle solve each pose once more, by the map so much later; 0 never");
  number("tracking.depth_weight", &t.depth_weight, 0, 10, "",
         "weight of the depth residual beside the paper's pixel residuals; 0 is the paper's eq. (5)");

  DirectConfig& a = c.direct;
  number("direct.below_inliers", &a.below_inliers, 0, 1000, "matches",
         "methods stillpoint and oracle align frames with fewer inliers directly too; 0 never any");
  number("direct.below_share", &a.below_share, 0, 1, "",
         "… and those with fewer than this share of what was usual lately");
  number("direct.cell_px", &a.cell_px, 8, 64, "px", "a cell of this side holds one patch");
  number("direct.coarsest_level", &a.coarsest_level, 0, 6, "", "pyramid level at which alignment begins");
  number("direct.finest_level", &a.finest_level, 0, 6, "", "pyramid level at which alignment ends");
  number("direct.iterations", &a.iterations, 1, 100, "steps", "most Gauss-Newton steps a level");
  number("direct.min_patches", &a.min_patches, 10, 5000, "patches",
         "with fewer in view no directly aligned pose is believed");
  number("direct.min_correlation", &a.min_correlation, 0, 1, "",
         "least correlation of the patches' brightness with the frame's");
  number("direct.min_agreement", &a.min_agreement, 0, 1, "",
         "least share of patches at whose place the expected depth is measured");
  number("direct.max_age", &a.max_age, 1, 30, "frames", "how far back the frame aligned with may lie");
  number("direct.pixel_share", &a.pixel_share, 0.0001, 1, "",
         "independent measurements a patch's pixel counts for when poses are fused");

  MapConfig& k = c.map;
  number("map.far_depth_m", &k.far_depth_m, 0.1, 50, "m",
         "points are made from depth up to here, farther only when few are near");
  number("map.min_new_points", &k.min_new_points, 0, 5000, "points",
         "so many nearest points are made however far");
  number("map.min_cell_points", &k.min_cell_points, 0, 1000, "points",
         "so many points are made in each part of the image of 80 px however far");
  number("map.keyframe_max_gap", &k.keyframe_max_gap, 1, 1000, "frames",
         "after so many frames a keyframe may be made whatever else");
  number("map.keyframe_min_ratio", &k.keyframe_min_ratio, 0, 1, "",
         "a keyframe is made when inliers fall below this share of the reference's");
  number("map.keyframe_min_near", &k.keyframe_min_near, 0, 5000, "features",
         "or fewer near features than this are tracked");
  number("map.keyframe_new_near", &k.keyframe_new_near, 0, 5000, "features",
         "while so many near ones wait to become points");
  number("map.cull_redundancy", &k.cull_redundancy, 0.1, 1, "",
         "a keyframe is culled when this share of its points is seen by three others");
  number("map.min_found_ratio", &k.min_found_ratio, 0, 1, "",
         "a young point found in less than this share of its sightings is culled");
  number("map.max_local_keyframes", &k.max_local_keyframes, 1, 500, "keyframes",
         "covisible keyframes in the local map");
  number("map.purge_moving", &k.purge_moving, 0, 1, "",
         "1 takes points on what method stillpoint finds moving out of the map");
  number("map.max_keyframes", &k.max_keyframes, 2, 10000, "keyframes", "beyond them the oldest retires");

  BundleConfig& b = c.bundle;
  number("bundle.max_keyframes", &b.max_keyframes, 1, 100, "keyframes", "local keyframes refined");
  number("bundle.max_fixed_keyframes", &b.max_fixed_keyframes, 1, 200, "keyframes",
         "keyframes that share their points, held fixed");
  number("bundle.iterations", &b.iterations, 1, 100, "steps", "most Levenberg-Marquardt steps");
  number("bundle.apply_after_frames", &b.apply_after_frames, 0, 10, "frames",
         "how long after its keyframe a result enters the map");
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
      const std::string line = line_prefix(path, value.source());
      assign(find_parameter(all, fmt::format("{}.{}", section.str(), key.str()), line), value, line);
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
  Parameter& parameter = find_parameter(all, key, "");
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
