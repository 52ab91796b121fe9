#pragma once

#include "core/motion/depth_motion.hpp"

namespace stillpoint {

/// Patches of one surface: pixels grouped by place and depth, about config.segment_px a side (SLIC, Achanta
/// et al. 2012, with depth for colour).
/// @param labels receives CV_32SC1: the patch of each pixel, -1 where there is no depth
[[nodiscard]] std::vector<Segment> segment_surfaces(const RgbdView& view, const DepthMotionConfig& config,
                                                    cv::Mat& labels);

/// Averages each pixel's log-odds over its patch, lets patches that continue into each other on one surface
/// agree, and decides which move.
void judge_segments(const RgbdView& view, const cv::Mat& log_odds, const cv::Mat& labels,
                    const DepthMotionConfig& config, std::vector<Segment>& segments);

/// Whether two depths (m) that lie side by side belong to one surface.
[[nodiscard]] inline bool same_surface(float a, float b) {
  const float nearer = a < b ? a : b;
  return (a > b ? a - b : b - a) < 0.02F + 0.012F * nearer * nearer;
}

}  // namespace stillpoint
