#include "core/inspect/layer_values.hpp"

#include <algorithm>
#include <cmath>

namespace stillpoint {

LevelHistogram level_histogram(const Layer& layer) {
  LevelHistogram histogram;
  double known = 0.0, above = 0.0;
  for (int y = 0; y < layer.image.rows; ++y)
    for (int x = 0; x < layer.image.cols; ++x) {
      if (!layer.valid.empty() && layer.valid.at<std::uint8_t>(y, x) == 0) continue;
      const std::uint8_t level = layer.image.at<std::uint8_t>(y, x);
      histogram.pixels[level] += 1.0;
      known += 1.0;
      if (layer.limit && static_cast<double>(level) > *layer.limit) above += 1.0;
      histogram.highest = std::max(histogram.highest, level + 1.0);
    }
  if (known > 0.0) histogram.above_share = above / known;
  return histogram;
}

cv::Mat signed_difference(const Layer& layer, const cv::Mat& seen) {
  cv::Mat from, to;
  seen.convertTo(to, CV_32F);
  layer.image.convertTo(from, CV_32F);
  cv::Mat difference = to - from;
  if (!layer.valid.empty()) difference.setTo(std::nanf(""), layer.valid == 0);
  return difference;
}

}  // namespace stillpoint
