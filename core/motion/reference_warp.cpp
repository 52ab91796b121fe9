#include "core/motion/reference_warp.hpp"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace stillpoint {

ReferenceWarp warp_reference(const RgbdView& current, const ReferenceView& reference) {
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  constexpr double kNearest = 0.1;  // m
  const cv::Size size = current.depth.size();
  cv::Mat places(size, CV_32FC2, cv::Scalar(-1, -1));
  ReferenceWarp warp;
  warp.shift = cv::Mat(size, CV_32FC1, cv::Scalar(kUnknown));
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const float z = current.depth.at<float>(y, x);
      if (z <= 0) continue;
      const Eigen::Vector3d there =
          reference.reference_from_current *
          current.camera.back_project({static_cast<double>(x), static_cast<double>(y)},
                                      static_cast<double>(z));
      if (there.z() < kNearest) continue;
      const Eigen::Vector2d pixel = current.camera.project(there);
      if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() > size.width - 1 || pixel.y() > size.height - 1)
        continue;
      places.at<cv::Vec2f>(y, x) = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
      warp.shift.at<float>(y, x) = static_cast<float>(std::hypot(pixel.x() - x, pixel.y() - y));
    }
  cv::remap(reference.view->gray, warp.gray, places, cv::Mat(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      if (std::isnan(warp.shift.at<float>(y, x))) warp.gray.at<float>(y, x) = kUnknown;
  return warp;
}

}  // namespace stillpoint
