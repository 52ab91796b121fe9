#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "core/motion/figure_info.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {

class OdometryEngine;
struct Camera;

/// What an odometry engine says of itself. Nothing outside core/odometry knows an engine by name.
struct EngineInfo {
  std::string name;             ///< the value of `--odometry`
  std::string title;            ///< for headings
  std::string summary;          ///< one sentence
  std::string citation;         ///< where it comes from; empty for none
  bool takes_weights = true;    ///< a motion method's weights count in it; a mask counts in every engine
  bool offers_matches = false;  ///< it has points that methods with MotionNeeds::matches can judge
  bool wants_orb = false;       ///< FramePreparer finds ORB features for it
  bool has_stages = false;      ///< FrameResult::engine describes its own stages; else the record tells all
  RecordParts measures{};       ///< what of a record it tells; the rest has no value, not 0
  AnySection parameters{};      ///< its own constants at their defaults; empty when it has none
  std::vector<FigureInfo> figures{};  ///< what it adds to FrameRecord::motion_figures
  std::unique_ptr<OdometryEngine> (*make)(const Camera& camera, const Config& config) = nullptr;
};

/// The engines there are, in the order of engines.cpp; the default is the first.
[[nodiscard]] const std::vector<EngineInfo>& engines();

[[nodiscard]] std::vector<std::string> engine_names();

/// @throws InputError naming those there are
[[nodiscard]] const EngineInfo& engine_named(const std::string& name);

/// The engine that a config runs.
[[nodiscard]] const EngineInfo& engine_of(const Config& config);

/// Why the config's method cannot stand in front of its engine, one sentence; empty where it can.
[[nodiscard]] std::string why_no_pair(const Config& config);

/// What a run is called: its method, and before it the engine where that is not the default: "dso/paper".
[[nodiscard]] std::string run_label(const Config& config);

/// The same as words: "method paper", "odometry dso, method paper".
[[nodiscard]] std::string run_words(const Config& config);

/// The engine that runs where none is named.
inline constexpr const char* kDefaultEngine = "features";

}  // namespace stillpoint
