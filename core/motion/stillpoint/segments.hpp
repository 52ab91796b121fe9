#pragma once

#include "core/motion/stillpoint/depth_motion.hpp"

namespace stillpoint {

/// Patches of one surface: pixels grouped by place and depth, about config.segment_px a side (SLIC, Achanta
/// et al. 2012, with depth for colour).
[[nodiscard]] SurfacePatches segment_surfaces(const RgbdView& view, const StillpointConfig& config);

/// Averages each pixel's log-odds over its patch, lets patches that continue into each other on one surface
/// agree, and decides which move.
void judge_segments(const cv::Mat& log_odds, const cv::Mat& labels, const std::vector<Contact>& contacts,
                    const StillpointConfig& config, std::vector<Segment>& segments);

}  // namespace stillpoint
