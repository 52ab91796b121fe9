#pragma once

#include "core/motion/motion_method.hpp"
#include "core/motion/stillpoint/depth_motion.hpp"
#include "core/motion/stillpoint/stillpoint_config.hpp"

namespace stillpoint {

/// What method `stillpoint` saw of a frame.
struct StillpointMotionTrace final : MotionTrace {
  StillpointTrace judged;
  std::shared_ptr<const RgbdView> view;  ///< the frame, downsampled
};

/// The stages of method `stillpoint`: an earlier frame after the other, then the judgement.
[[nodiscard]] StageLog describe_stillpoint(const Frame& frame, const StillpointMotionTrace& trace,
                                           const StillpointConfig& config);

}  // namespace stillpoint
