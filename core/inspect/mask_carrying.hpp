#pragma once

#include <opencv2/core.hpp>

#include "core/sequence/frame.hpp"

namespace stillpoint {

// A mask of one frame as a proposal for another: along dense optical flow, its outline then drawn to where
// depth steps.

/// Where a mask of one frame lies in another, a moment before or after.
///
/// Flow is dense inverse search (Kroeger et al. 2016) from `to` to `from`, so that every pixel of `to` looks
/// up one of `from`. Near the outline a pixel goes to whichever of the two sides its depth is more like;
/// where depth is missing or the sides are equally far, flow's word stands.
/// @param from, to readable, of one size; depth of `to` may be missing
/// @param mask CV_8UC1, 255 = dynamic, of `from`
/// @returns the same of `to`. The same bytes under one cv::setNumThreads
[[nodiscard]] cv::Mat carried_mask(const Frame& from, const cv::Mat& mask, const Frame& to);

/// A mask between two, by their signed distances: the first at share 0, the second at share 1.
/// @param earlier, later CV_8UC1 of one size, 255 = dynamic
[[nodiscard]] cv::Mat blended_mask(const cv::Mat& earlier, const cv::Mat& later, double share);

}  // namespace stillpoint
