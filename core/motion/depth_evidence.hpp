#pragma once

#include "core/motion/depth_motion.hpp"

namespace stillpoint {

// The per-pixel part of detect_depth_motion; see there.

/// Carries every pixel of `current` into the reference and compares depth, then brightness.
[[nodiscard]] ReferenceEvidence compare_with_reference(const RgbdView& current,
                                                       const ReferenceView& reference,
                                                       const DepthMotionConfig& config);

/// The log-odds of the frame before, brought to where they belong now: by the camera's motion for what stands
/// still, and within reach of a mover's step for what does not, onto pixels at a like depth.
[[nodiscard]] cv::Mat carry_memory(const RgbdView& current, const MotionMemory& memory,
                                   const Pose& previous_from_current, const DepthMotionConfig& config);

}  // namespace stillpoint
