#include "core/motion/paper/cleanup.hpp"

#include <opencv2/imgproc.hpp>

namespace stillpoint {

cv::Mat clean_mask(const cv::Mat& raw_mask, const cv::Mat& valid, const PaperConfig& config) {
  const auto square = [](int side) { return cv::Mat::ones(side, side, CV_8UC1); };
  const int erode_anchor = config.erode_kernel_px / 2;
  const int dilate_anchor = (config.dilate_kernel_px - 1) / 2;
  cv::Mat mask;
  cv::erode(raw_mask, mask, square(config.erode_kernel_px), {erode_anchor, erode_anchor},
            config.erode_iterations);
  cv::dilate(mask, mask, square(config.dilate_kernel_px), {dilate_anchor, dilate_anchor},
             config.dilate_iterations);
  cv::bitwise_and(mask, valid, mask);
  return mask;
}

}  // namespace stillpoint
