#pragma once

#include <vector>

#include "core/motion/stillpoint/depth_motion.hpp"

namespace stillpoint {

/// Finds superpixels that went back, away from the camera, farther than a superpixel can be followed by its
/// own depth: at their place the reference shows a surface some decimetres nearer. That surface may as well
/// have been another one, which has left since; so it must have the superpixel's shape, all of it nearer by
/// the same step, and, about where the superpixel was before that step along its ray or along the optical
/// axis, the superpixel's texture. What is plain says nothing.
/// @param noise_floor m, what registration leaves of the steps of what is static, standard deviation
/// @param motions one a superpixel; those with nothing to say yet (log_odds 0) are looked at
void measure_axial_motion(const RgbdView& current, const RgbdView& reference,
                          const Pose& reference_from_current, const cv::Mat& labels,
                          const std::vector<Superpixel>& superpixels, double noise_floor,
                          std::vector<SuperpixelMotion>& motions);

}  // namespace stillpoint
