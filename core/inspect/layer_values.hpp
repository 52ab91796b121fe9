#pragma once

#include <array>

#include "core/motion/stage_log.hpp"

namespace stillpoint {

// What panels show of a layer beside its image.

/// How often each grey level occurs among the pixels with data.
struct LevelHistogram {
  std::array<double, 256> pixels{};
  double highest = 0.0;      ///< one above the highest level that occurs
  double above_share = 0.0;  ///< of the pixels with data: above the layer's limit, 0 to 1
};

/// @param layer CV_8UC1 with a limit
[[nodiscard]] LevelHistogram level_histogram(const Layer& layer);

/// What was seen less the layer, grey levels, CV_32FC1; NaN where the layer has no data.
/// @param seen CV_8UC1 of the layer's size
[[nodiscard]] cv::Mat signed_difference(const Layer& layer, const cv::Mat& seen);

}  // namespace stillpoint
