#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace stillpoint {

/// An image as stored, or why there is none.
struct ImageRead {
  cv::Mat image;  ///< the file's own depth and channels (colour as BGR); empty when it could not be read
  std::string problem;  ///< one sentence, empty when all is well
  bool is_other_format =
      false;               ///< whole, as far as one sees, but in a format that is not read (NumPy, OpenEXR)
  bool in_metres = false;  ///< depth as CV_32FC1 in metres, 0 = no measurement, as bags have it
};

/// Whether a file's name ends as those of images do.
[[nodiscard]] bool is_image_name(const std::string& file);

/// Reads a PNG, JPEG or other image that OpenCV decodes. A PNG is checked chunk by chunk and a JPEG for its
/// end before a decoder sees it, so that a truncated or damaged file gives a problem rather than half an
/// image, and decoders have nothing to print. Never throws.
[[nodiscard]] ImageRead read_image(const std::string& path);

/// A file's bytes.
using Bytes = std::vector<unsigned char>;

/// All bytes of a file, however it grows meanwhile.
/// @return why there are none, as the end of a sentence that begins with its name; empty when all is well
[[nodiscard]] std::string read_bytes(const std::string& path, Bytes& bytes);

/// read_image of a file's bytes; `path` names it in messages. Never throws.
[[nodiscard]] ImageRead decode_image(const std::string& path, Bytes bytes);

/// Any image read as 8-bit grey or 8-bit BGR: 16-bit values scaled down, an alpha channel dropped.
[[nodiscard]] cv::Mat to_8bit(const cv::Mat& image);

/// An 8-bit image of 1 or 3 channels as grey.
[[nodiscard]] cv::Mat to_gray(const cv::Mat& image);

}  // namespace stillpoint
