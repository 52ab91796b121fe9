#include "core/inspect/layer_values.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

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

LevelHistogram level_histogram(const cv::Mat& picture) {
  LevelHistogram histogram;
  const cv::Mat levels = picture.reshape(1);
  for (int y = 0; y < levels.rows; ++y)
    for (int x = 0; x < levels.cols; ++x) {
      const std::uint8_t level = levels.at<std::uint8_t>(y, x);
      histogram.pixels[level] += 1.0;
      histogram.highest = std::max(histogram.highest, level + 1.0);
    }
  return histogram;
}

cv::Mat developed(const cv::Mat& picture, Channel channel, double stops) {
  cv::Mat image = picture;
  if (channel == Channel::grey && picture.channels() == 3) cv::cvtColor(picture, image, cv::COLOR_BGR2GRAY);
  if (channel >= Channel::red && picture.channels() == 3)
    cv::extractChannel(picture, image, channel == Channel::red ? 2 : channel == Channel::green ? 1 : 0);
  if (stops == 0.0) return image;
  cv::Mat brighter;
  image.convertTo(brighter, -1, std::exp2(stops));
  return brighter;
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
