#pragma once

#include "core/motion/stillpoint/depth_motion.hpp"

namespace stillpoint {

/// What comes into view beside a surface is taken to be what that surface is: a person the camera turns to,
/// known to be dynamic by an arm, moves all over. Pixels that lay outside the frame before take the log-odds
/// that the rest of their superpixel remembers, or, where all of it is new, its neighbours on the same
/// surface, as far as they speak for moving. (What was hidden in the frame before is warp_prior's.)
/// @param newly_observed CV_8UC1, as WarpedPrior has it
/// @param prior CV_32FC1 log-odds as warped along; written where `newly_observed` is set
void propagate_labels(const cv::Mat& newly_observed, const Superpixels& superpixels, cv::Mat& prior);

}  // namespace stillpoint
