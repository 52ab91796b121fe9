#pragma once

#include "core/geometry/se3.hpp"
#include "core/motion/rgbd_view.hpp"

namespace stillpoint {

/// What comes into view beside a surface is taken to be what that surface is: a person the camera turns to,
/// known to move by an arm, moves all over. Pixels that lay outside the frame before take the log-odds that
/// the rest of their patch remembers, or, where all of it is new, its neighbours on the same surface, as far
/// as they speak for moving. (What was hidden in the frame before is carry_memory's.)
/// @param labels CV_32SC1, patches as segment_surfaces gives them, `patches` of them
/// @param prior CV_32FC1 log-odds as carried along; written where pixels lay outside the frame before
void inherit_memory(const RgbdView& current, const cv::Mat& labels, std::size_t patches,
                    const Pose& previous_from_current, cv::Mat& prior);

}  // namespace stillpoint
