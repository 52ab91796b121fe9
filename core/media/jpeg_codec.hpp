#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace stillpoint {

// JPEGs of the usual kinds by libjpeg alone, as OpenCV reads and writes them, pixel for pixel and byte for
// byte.

/// A JPEG in grey or colour that can be decoded to its end, with whatever warnings: CV_8UC1 or CV_8UC3 (BGR).
/// Empty for all else.
/// @throws InputError for one of more pixels or scans than there can be
/// @param is_damaged receives whether it is a JPEG that libjpeg can make no image of, whoever asks it
[[nodiscard]] cv::Mat decode_plain_jpeg(const std::vector<unsigned char>& bytes, bool* is_damaged = nullptr);

/// A baseline JPEG with colour at half resolution. @param image CV_8UC1 or CV_8UC3 (BGR)
/// @param quality 0 to 100
/// @returns nothing for another image
[[nodiscard]] std::vector<unsigned char> encode_plain_jpeg(const cv::Mat& image, int quality);

}  // namespace stillpoint
