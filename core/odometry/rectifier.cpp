#include "core/odometry/rectifier.hpp"

#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace stillpoint {

Rectifier::Rectifier(const Camera& camera) : camera_(camera), pinhole_(camera) {
  pinhole_.k1 = pinhole_.k2 = pinhole_.p1 = pinhole_.p2 = pinhole_.k3 = 0.0;
  auto tables = std::make_shared<Tables>();
  if (camera.has_distortion()) {
    tables->into.create(camera.height, camera.width, CV_32FC2);
    tables->seen = cv::Mat(camera.height, camera.width, CV_8UC1, cv::Scalar(0));
    std::vector<cv::Point2f> pixels;
    pixels.reserve(tables->into.total());
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const Eigen::Vector2d at = camera.distort({x, y});
        tables->into.at<cv::Vec2f>(y, x) = {static_cast<float>(at.x()), static_cast<float>(at.y())};
        const bool inside =
            at.x() >= 0 && at.y() >= 0 && at.x() <= camera.width - 1 && at.y() <= camera.height - 1;
        tables->seen.at<std::uint8_t>(y, x) = inside ? 255 : 0;
        pixels.emplace_back(static_cast<float>(x), static_cast<float>(y));
      }
    const std::vector<cv::Point2f> undistorted = camera.undistort(pixels);
    tables->back = cv::Mat(undistorted, true).reshape(2, camera.height);
  }
  tables_ = std::move(tables);
}

cv::Mat Rectifier::smooth(const cv::Mat& image) const {
  if (tables_->into.empty() || image.empty()) return image;
  cv::Mat rectified;
  cv::remap(image, rectified, tables_->into, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return rectified;
}

cv::Mat Rectifier::nearest(const cv::Mat& image) const {
  if (tables_->into.empty() || image.empty()) return image;
  cv::Mat rectified;
  cv::remap(image, rectified, tables_->into, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  return rectified;
}

cv::Mat Rectifier::to_image(const cv::Mat& rectified) const {
  if (tables_->back.empty() || rectified.empty()) return rectified;
  cv::Mat image;
  cv::remap(rectified, image, tables_->back, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT,
            cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  return image;
}

cv::Point2f Rectifier::to_image(const cv::Point2f& rectified) const {
  if (!camera_.has_distortion()) return rectified;
  const Eigen::Vector2d at = camera_.distort({rectified.x, rectified.y});
  return {static_cast<float>(at.x()), static_cast<float>(at.y())};
}

}  // namespace stillpoint
