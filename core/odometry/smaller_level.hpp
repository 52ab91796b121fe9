#pragma once

#include <opencv2/core.hpp>

#include "core/wide_lanes.hpp"

namespace stillpoint {

/// The next level of a pyramid: what cv::resize makes by INTER_LINEAR, to its last bit.
/// @param level CV_8UC1
/// @param size px, at most the level's
/// @param wide eight pixels at a time, for processors with AVX2 and levels less than twice as large; else by
/// OpenCV, which looks up each pixel by itself
void make_smaller_level(const cv::Mat& level, const cv::Size& size, cv::Mat& smaller,
                        bool wide = has_wide_lanes());

}  // namespace stillpoint
