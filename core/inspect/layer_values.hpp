#pragma once

#include <array>

#include "core/motion/stage_log.hpp"

namespace stillpoint {

// What panels show of a layer, or of a frame, beside its image.

/// How often each grey level occurs among the pixels with data.
struct LevelHistogram {
  std::array<double, 256> pixels{};
  double highest = 0.0;      ///< one above the highest level that occurs
  double above_share = 0.0;  ///< of the pixels with data: above the layer's limit, 0 to 1
};

/// @param layer CV_8UC1 with a limit
[[nodiscard]] LevelHistogram level_histogram(const Layer& layer);

/// What of a picture is looked at.
enum class Channel { all, grey, red, green, blue };

/// A picture as a photographer would look at it: one channel, or all, times two to the power of `stops`, cut
/// off at white.
/// @param picture CV_8UC1 or CV_8UC3 (BGR); of a grey one every channel is the grey
/// @returns CV_8UC1, or of all channels the picture's type
[[nodiscard]] cv::Mat developed(const cv::Mat& picture, Channel channel, double stops);

/// How often each level occurs in a picture: of a colour one over all three channels together.
/// @param picture CV_8UC1 or CV_8UC3
[[nodiscard]] LevelHistogram level_histogram(const cv::Mat& picture);

/// What was seen less the layer, grey levels, CV_32FC1; NaN where the layer has no data.
/// @param seen CV_8UC1 of the layer's size
[[nodiscard]] cv::Mat signed_difference(const Layer& layer, const cv::Mat& seen);

}  // namespace stillpoint
