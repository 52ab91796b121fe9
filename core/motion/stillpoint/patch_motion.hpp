#pragma once

#include <cmath>

#include "core/motion/stillpoint/depth_motion.hpp"

namespace stillpoint {

/// How the patches of a frame moved against a reference, and the camera's motion with them.
struct PatchMotions {
  std::vector<PatchMotion> patches;                ///< one a segment
  Pose reference_from_current = Pose::Identity();  ///< as most patches have it
  int measured = 0;                                ///< patches that said something
};

/// log p(step | moves) - log p(step | stands still): Gaussians about 0, the one wider by what movers
/// typically go.
/// @param step m; @param still m², variance of what stands still; @param typical m
[[nodiscard]] inline double step_log_odds(double step, double still, double typical) {
  const double moved = still + typical * typical;
  return 0.5 * step * step * (1.0 / still - 1.0 / moved) - 0.5 * std::log(moved / still);
}

/// Finds slow movers. Every patch of surface is laid onto the reference by the camera's motion and shifted to
/// where brightness fits best (one Lucas-Kanade step, centred, so that shading says nothing); the camera's
/// motion that explains most patches is found by robust least squares, every patch with about one vote; what
/// a patch is shifted beyond it is weighed as "stands still, up to what registration leaves" against "moves
/// by something like a pixel". A patch without texture in a direction says nothing about it.
/// @param prior CV_32FC1 log-odds of moving: what is known to move has little say in the camera's motion
[[nodiscard]] PatchMotions measure_patches(const RgbdView& current, const ReferenceView& reference,
                                           const cv::Mat& labels, const std::vector<Segment>& segments,
                                           const cv::Mat& prior, const StillpointConfig& config);

}  // namespace stillpoint
