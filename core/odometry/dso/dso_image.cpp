#include "core/odometry/dso/dso_image.hpp"

#include <opencv2/imgproc.hpp>

namespace stillpoint {

std::shared_ptr<const DsoImage> make_dso_image(const cv::Mat& gray, const Camera& camera, int levels) {
  auto image = std::make_shared<DsoImage>();
  cv::Mat level;
  gray.convertTo(level, CV_32F);
  for (int i = 0; i < levels; ++i) {
    if (i > 0) {
      if (level.cols < 32 || level.rows < 32) break;
      cv::Mat half;
      cv::resize(level, half, {level.cols / 2, level.rows / 2}, 0, 0, cv::INTER_AREA);
      level = half;
    }
    cv::Mat slopes(level.size(), CV_32FC3, cv::Scalar(0, 0, 0));
    for (int y = 0; y < level.rows; ++y) {
      const float* row = level.ptr<float>(y);
      const float* above = level.ptr<float>(std::max(0, y - 1));
      const float* below = level.ptr<float>(std::min(level.rows - 1, y + 1));
      auto* out = slopes.ptr<cv::Vec3f>(y);
      for (int x = 0; x < level.cols; ++x)
        out[x] = {row[x], 0.5F * (row[std::min(level.cols - 1, x + 1)] - row[std::max(0, x - 1)]),
                  0.5F * (below[x] - above[x])};
    }
    image->levels.push_back(slopes);
    image->cameras.push_back(camera.scaled_to(level.cols, level.rows));
  }
  return image;
}

}  // namespace stillpoint
