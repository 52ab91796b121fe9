#pragma once

#include "core/motion/epipolar/colour_motion.hpp"
#include "core/motion/epipolar/epipolar_config.hpp"
#include "core/motion/motion_method.hpp"

namespace stillpoint {

/// What method `epipolar` saw of a frame.
struct EpipolarMotionTrace final : MotionTrace {
  EpipolarTrace judged;
  std::shared_ptr<const ColourMotionDetector> after;  ///< its state once it has seen the frame
};

/// The stages of method `epipolar`: points, the camera's motion against earlier frames, evidence, mask.
[[nodiscard]] StageLog describe_epipolar(const Frame& frame, const EpipolarTrace& trace,
                                         const EpipolarConfig& config);

}  // namespace stillpoint
