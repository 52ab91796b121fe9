#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace stillpoint {

/// A PNG (ISO/IEC 15948) of 8 or 16 bits a sample, not interlaced, without palette or transparent colour,
/// inflated by libdeflate: CV_8U or CV_16U with 1, 3 (BGR) or 4 (BGRA) channels. Checksums of chunks are not
/// looked at. Empty for all else, damaged ones included; OpenCV gives the same pixels, and more patience.
[[nodiscard]] cv::Mat decode_plain_png(const std::vector<unsigned char>& bytes);

}  // namespace stillpoint
