#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace stillpoint {

/// A PNG (ISO/IEC 15948) of 8 bits a sample, packed fast rather than small by libdeflate; rows are told by
/// what is left of each pixel.
/// @param image CV_8U with 1, 3 (BGR) or 4 (BGRA) channels; empty for others and for an empty one
[[nodiscard]] std::vector<unsigned char> encode_plain_png(const cv::Mat& image);

}  // namespace stillpoint
