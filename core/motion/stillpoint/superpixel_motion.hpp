#pragma once

#include <cmath>

#include "core/motion/stillpoint/depth_motion.hpp"

namespace stillpoint {

/// How the superpixels of a frame moved against a reference, and the camera's motion with them.
struct SuperpixelMotions {
  std::vector<SuperpixelMotion> motions;           ///< one a superpixel
  Pose reference_from_current = Pose::Identity();  ///< as most superpixels have it
  int measured = 0;                                ///< superpixels that said something
};

/// log p(step | moves) - log p(step | is static): Gaussians about 0, the one wider by what dynamic objects
/// typically go.
/// @param step m; @param still m², variance of what is static; @param typical m
[[nodiscard]] inline double step_log_odds(double step, double still, double typical) {
  const double moved = still + typical * typical;
  return 0.5 * step * step * (1.0 / still - 1.0 / moved) - 0.5 * std::log(moved / still);
}

/// Finds slow dynamic objects. Every superpixel of surface is laid onto the reference by the camera's motion
/// and shifted to where brightness fits best (one Lucas-Kanade step, centred, so that shading says nothing);
/// the camera's motion that explains most superpixels is found by robust least squares, every superpixel with
/// about one vote; what a superpixel is shifted beyond it is weighed as "is static, up to what registration
/// leaves" against "moves by something like a pixel". A superpixel without texture in a direction says
/// nothing about it.
/// @param prior CV_32FC1 log-odds of moving: what is known to be dynamic has little say in the camera's
/// motion
[[nodiscard]] SuperpixelMotions measure_superpixels(const RgbdView& current, const ReferenceView& reference,
                                                    const cv::Mat& labels,
                                                    const std::vector<Superpixel>& superpixels,
                                                    const cv::Mat& prior, const StillpointConfig& config);

}  // namespace stillpoint
