#pragma once

#include "core/motion/stillpoint/depth_motion.hpp"

namespace stillpoint {

/// What comes into view beside a surface is taken to be what that surface is: a person the camera turns to,
/// known to move by an arm, moves all over. Pixels that lay outside the frame before take the log-odds that
/// the rest of their patch remembers, or, where all of it is new, its neighbours on the same surface, as far
/// as they speak for moving. (What was hidden in the frame before is carry_memory's.)
/// @param entered CV_8UC1, as CarriedMemory has it
/// @param prior CV_32FC1 log-odds as carried along; written where `entered` is set
void inherit_memory(const cv::Mat& entered, const SurfacePatches& patches, cv::Mat& prior);

}  // namespace stillpoint
