#include "ui/gl/mipmaps.hpp"

#include <algorithm>

namespace stillpoint {
namespace {

std::uint8_t mean(std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>((a + b + 1) >> 1); }
float mean(float a, float b) { return a + (b - a) * 0.5F; }

template <typename Sample, int channels>
cv::Mat halved(const cv::Mat& image) {
  cv::Mat half(image.rows / 2, image.cols / 2, image.type());
  for (int y = 0; y < half.rows; ++y) {
    const auto *upper = image.ptr<Sample>(2 * y), *lower = image.ptr<Sample>(2 * y + 1);
    auto* to = half.ptr<Sample>(y);
    for (int x = 0; x < half.cols; ++x, upper += 2 * channels, lower += 2 * channels)
      for (int c = 0; c < channels; ++c)
        *to++ = mean(mean(upper[c], upper[c + channels]), mean(lower[c], lower[c + channels]));
  }
  return half;
}

/// @param image of 1, 3 or 4 channels
template <typename Sample>
cv::Mat halved(const cv::Mat& image) {
  return image.channels() == 1   ? halved<Sample, 1>(image)
         : image.channels() == 3 ? halved<Sample, 3>(image)
                                 : halved<Sample, 4>(image);
}

}  // namespace

std::vector<cv::Mat> halved_levels(const cv::Mat& image) {
  constexpr int kSmallEnough = 32;  // px: nothing that is looked at is drawn smaller
  std::vector<cv::Mat> levels;
  cv::Mat last = image;
  while (!last.empty() && last.cols % 2 == 0 && last.rows % 2 == 0) {
    last = last.depth() == CV_32F ? halved<float>(last) : halved<std::uint8_t>(last);
    levels.push_back(last);
  }
  if (std::min(last.cols, last.rows) > kSmallEnough) levels.clear();
  return levels;
}

}  // namespace stillpoint
