#pragma once

#include "core/motion/stillpoint/depth_motion.hpp"

namespace stillpoint {

// The per-pixel part of detect_depth_motion; see there.

/// Warps every pixel of `current` into the reference and compares depth, then brightness.
/// @param prior CV_32FC1, prior log-odds of each pixel: how exact the comparison can be is judged by
/// what is not classified as dynamic
/// @param wide eight pixels at a time, for processors that have such lanes; the evidence is the same
[[nodiscard]] ReferenceEvidence compare_with_reference(const RgbdView& current,
                                                       const ReferenceView& reference, const cv::Mat& prior,
                                                       const StillpointConfig& config,
                                                       bool wide = has_wide_lanes());

/// The prior, at a later frame's pixels.
struct WarpedPrior {
  cv::Mat log_odds;        ///< CV_32FC1, of moving; 0 = nothing is known
  cv::Mat newly_observed;  ///< CV_8UC1, 255: measured now, and outside the view of the frame before
};

/// The log-odds of the frame before, brought to where they belong now: by the camera's motion for what stands
/// still, and within reach of a dynamic object's step for what does not, onto pixels at a like depth.
/// @param wide as of compare_with_reference()
[[nodiscard]] WarpedPrior warp_prior(const RgbdView& current, const MotionPrior& before,
                                     const Pose& previous_from_current, const StillpointConfig& config,
                                     bool wide = has_wide_lanes());

}  // namespace stillpoint
