#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/odometry/feature_set.hpp"
#include "core/odometry/orb_blur.hpp"
#include "core/wide_lanes.hpp"

namespace stillpoint {

constexpr int kOrbPatchRadius = 15;  // px: half the patch a descriptor tells of
constexpr int kOrbBorder = 19;  // px: patches of corners this far from the edge stay inside, however turned

/// Descriptors of a level's corners: those of cv::ORB (Rublee et al. 2011), bit by bit.
/// @param level CV_8UC1
/// @param corners at whole pixels, kOrbBorder or more from the level's edges, and with their angles
/// @param blurred memory that is used again from level to level
/// @param wide by code of our own for processors with AVX2, which takes a third of the time; else by OpenCV
void describe_corners(const cv::Mat& level, const std::vector<cv::KeyPoint>& corners, BlurredLevel& blurred,
                      std::vector<Descriptor>& descriptors, bool wide = has_wide_lanes());

}  // namespace stillpoint
