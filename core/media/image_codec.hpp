#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace stillpoint {

// Images as bytes. PNGs of the usual kinds are read by libdeflate (png_decoder.hpp) and written by libspng,
// JPEGs go through libjpeg; all else through OpenCV's codecs (media_module.hpp), which give the same pixels.

/// The pixels of an encoded image as they are stored: CV_8U or CV_16U with 1, 3 (BGR) or 4 (BGRA) channels,
/// or what the format holds. The tag of orientation is ignored. Empty where the bytes are no image that can
/// be decoded.
[[nodiscard]] cv::Mat decode_pixels(const std::vector<unsigned char>& bytes);

/// A PNG. @param image CV_8U or CV_16U of 1, 3 or 4 channels @param level 1 (quick) to 9 (small)
/// @returns nothing where it cannot be encoded
[[nodiscard]] std::vector<unsigned char> encode_png(const cv::Mat& image, int level);

/// A PNG of what a camera took or of its mask, quickly: noisy colours, depth in steps, areas of one value.
/// @param image as above @returns nothing where it cannot be encoded
[[nodiscard]] std::vector<unsigned char> encode_camera_png(const cv::Mat& image);

/// A JPEG. @param image CV_8UC1 or CV_8UC3 @param quality 0 to 100
/// @returns nothing where it cannot be encoded
[[nodiscard]] std::vector<unsigned char> encode_jpeg(const cv::Mat& image, int quality);

/// Writes an image, whole or not at all, in the format that the path's ending names.
/// @returns whether it could be written
[[nodiscard]] bool save_image(const std::filesystem::path& path, const cv::Mat& image, int png_level = 3);

}  // namespace stillpoint
