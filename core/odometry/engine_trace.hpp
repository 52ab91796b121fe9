#pragma once

#include <memory>
#include <vector>

#include "core/motion/stage_log.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// The group that all of an odometry engine's stages stand under.
inline constexpr const char* kOdometryGroup = "Odometry";

/// Everything an engine saw of a frame: its own type. What it shows is what it used.
struct EngineTrace {
  virtual ~EngineTrace() = default;
  /// The frame's way through the engine, in terms of StageLog, under kOdometryGroup.
  [[nodiscard]] virtual std::vector<Stage> describe(const Frame& frame) const = 0;
};

}  // namespace stillpoint
