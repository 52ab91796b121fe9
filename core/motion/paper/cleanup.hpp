#pragma once

#include <opencv2/core.hpp>

#include "core/motion/paper/paper_config.hpp"
#include "core/wide_lanes.hpp"

namespace stillpoint {

/// METHOD.md §1 step 4: erode (4x4, twice), dilate (16x16, once), and nothing where the warp has no data.
///
/// An even kernel has no middle pixel. The erosion's anchor is the one right below the middle (k/2, as
/// OpenCV's), the dilation's the one left above it, its mirror image: so kernels of one size would put a
/// shape back where it was, and with the paper's sizes the result lies half a pixel off centre. Pixels
/// outside the image neither erode nor dilate.
/// @param raw_mask,valid CV_8UC1, 0 or 255, one size
/// @param wide 32 pixels at once, for processors with AVX2; the result is the same
[[nodiscard]] cv::Mat clean_mask(const cv::Mat& raw_mask, const cv::Mat& valid, const PaperConfig& config,
                                 bool wide = has_wide_lanes());

}  // namespace stillpoint
