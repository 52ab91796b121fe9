#pragma once

#include "core/motion/stillpoint/depth_motion.hpp"
#include "core/wide_lanes.hpp"

namespace stillpoint {

/// Superpixels of one surface: pixels grouped by place and depth, about config.superpixel_px a side (SLIC,
/// Achanta et al. 2012, with depth for colour).
/// @param wide eight pixels at a time, for processors that have such lanes; the superpixels are the same
[[nodiscard]] Superpixels make_superpixels(const RgbdView& view, const StillpointConfig& config,
                                           bool wide = has_wide_lanes());

/// Averages each pixel's log-odds over its superpixel, lets superpixels that continue into each other on one
/// surface agree, and decides which move.
void judge_superpixels(const cv::Mat& log_odds, const cv::Mat& labels,
                       const std::vector<AdjacencyEdge>& adjacency, const StillpointConfig& config,
                       std::vector<Superpixel>& superpixels);

}  // namespace stillpoint
