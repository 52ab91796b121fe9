#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace stillpoint {

// JPEGs of the usual kinds by libjpeg alone, as OpenCV reads and writes them, pixel for pixel and byte for
// byte.

/// A sound JPEG in grey or colour: CV_8UC1 or CV_8UC3 (BGR). Empty for all else, a damaged one included.
[[nodiscard]] cv::Mat decode_plain_jpeg(const std::vector<unsigned char>& bytes);

/// A baseline JPEG with colour at half resolution. @param image CV_8UC1 or CV_8UC3 (BGR)
/// @param quality 0 to 100
/// @returns nothing for another image
[[nodiscard]] std::vector<unsigned char> encode_plain_jpeg(const cv::Mat& image, int quality);

}  // namespace stillpoint
