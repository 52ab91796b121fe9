#include "core/sequence/generated/texture.hpp"

#include <opencv2/imgproc.hpp>

namespace stillpoint::generated {

Texture::Texture(const cv::Mat& bgr) {
  cv::Mat level = bgr;
  while (true) {
    levels_.push_back({level.cols, level.rows, static_cast<std::int32_t>(texels_.size())});
    for (int y = 0; y < level.rows; ++y)
      for (int x = 0; x <= level.cols; ++x) {
        const auto& p = level.at<cv::Vec3b>(y, x % level.cols);
        texels_.push_back(static_cast<std::uint32_t>(p[0]) | static_cast<std::uint32_t>(p[1]) << 8 |
                          static_cast<std::uint32_t>(p[2]) << 16);
      }
    if (level.cols <= 2 || level.rows <= 2) break;
    cv::Mat half;
    cv::resize(level, half, cv::Size(level.cols / 2, level.rows / 2), 0, 0, cv::INTER_AREA);
    level = half;
  }
  last_ = static_cast<int>(levels_.size()) - 1;
}

}  // namespace stillpoint::generated
