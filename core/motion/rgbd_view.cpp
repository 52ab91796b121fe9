#include "core/motion/rgbd_view.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace stillpoint {
namespace {

/// The block's middle measurement, or the next best one of it.
float block_depth(const cv::Mat& depth, int x0, int y0, int factor) {
  const int middle = factor / 2;
  const float centre = depth.at<float>(y0 + middle, x0 + middle);
  if (centre > 0) return centre;
  for (int y = y0; y < y0 + factor; ++y)
    for (int x = x0; x < x0 + factor; ++x)
      if (const float z = depth.at<float>(y, x); z > 0) return z;
  return 0.0F;
}

cv::Mat steepest_neighbour(const cv::Mat& gray) {
  cv::Mat low, high, range;
  const cv::Mat cross = cv::getStructuringElement(cv::MORPH_CROSS, {3, 3});
  cv::erode(gray, low, cross);
  cv::dilate(gray, high, cross);
  high -= gray;
  low = gray - low;
  cv::max(high, low, range);
  return range;
}

}  // namespace

RgbdView make_rgbd_view(const cv::Mat& gray, const cv::Mat& depth, const Camera& camera, int factor) {
  RgbdView view;
  view.factor = factor;
  const cv::Size size(gray.cols / factor, gray.rows / factor);
  cv::Mat small;
  cv::resize(gray(cv::Rect(0, 0, size.width * factor, size.height * factor)), small, size, 0, 0,
             cv::INTER_AREA);
  small.convertTo(view.gray, CV_32F);
  view.gradient = steepest_neighbour(view.gray);
  view.depth = cv::Mat::zeros(size, CV_32FC1);
  for (int y = 0; y < size.height && !depth.empty(); ++y)
    for (int x = 0; x < size.width; ++x)
      view.depth.at<float>(y, x) = block_depth(depth, x * factor, y * factor, factor);
  view.camera = camera.scaled_to(gray.cols, gray.rows);
  view.camera.fx /= factor, view.camera.fy /= factor;
  view.camera.cx = (view.camera.cx + 0.5) / factor - 0.5,
  view.camera.cy = (view.camera.cy + 0.5) / factor - 0.5;
  view.camera.width = size.width, view.camera.height = size.height;
  return view;
}

}  // namespace stillpoint
