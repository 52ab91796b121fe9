#pragma once

#include "core/motion/stillpoint/depth_motion.hpp"

namespace stillpoint {

/// Superpixels of one surface: pixels grouped by place and depth, about config.superpixel_px a side (SLIC,
/// Achanta et al. 2012, with depth for colour).
[[nodiscard]] Superpixels make_superpixels(const RgbdView& view, const StillpointConfig& config);

/// Averages each pixel's log-odds over its superpixel, lets superpixels that continue into each other on one
/// surface agree, and decides which move.
void judge_superpixels(const cv::Mat& log_odds, const cv::Mat& labels,
                       const std::vector<AdjacencyEdge>& adjacency, const StillpointConfig& config,
                       std::vector<Superpixel>& superpixels);

}  // namespace stillpoint
