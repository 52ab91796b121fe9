#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

#include "core/wide_lanes.hpp"

namespace stillpoint {

/// The largest value that is written: 65535 stands for no measurement with some cameras.
inline constexpr int kMostStored = 65534;

/// Depth as images of 16 bits hold it.
struct StoredDepth {
  cv::Mat image;    ///< CV_16UC1
  int too_far = 0;  ///< pixels whose depth 16 bits cannot hold: they have no measurement in `image`
};

/// Rounds to nearest. What is too far is not written as the farthest depth there is: whoever reads it would
/// take that for measured.
/// @param metres CV_32FC1, 0 = no measurement @param units a metre, above 0 @param none of a pixel without a
/// measurement
[[nodiscard]] StoredDepth stored_depth(const cv::Mat& metres, double units, std::uint16_t none = 0);

/// Depth in metres, CV_32FC1, of an image of 16 bits; 0 where nothing was measured, be it stored as 0 or as
/// 65535. @param stored CV_16UC1 @param units a metre, above 0
/// @param wide eight pixels at a time, for processors that have such lanes; depth is the same
[[nodiscard]] cv::Mat metres_of(const cv::Mat& stored, double units, bool wide = has_wide_lanes());

/// What to tell of pixels that were too far, in a sentence; "" where there are none.
/// @param units a metre, as stored
[[nodiscard]] std::string too_far_told(std::int64_t pixels, double units);

}  // namespace stillpoint
