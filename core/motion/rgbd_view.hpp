#pragma once

#include <opencv2/core.hpp>

#include "core/geometry/camera.hpp"

namespace stillpoint {

/// A frame made small for judging motion pixel by pixel: what a mask needs, at a sixteenth of the work.
struct RgbdView {
  cv::Mat gray;      ///< CV_32FC1, grey levels, averaged over each block
  cv::Mat gradient;  ///< CV_32FC1, largest difference to a neighbour, grey levels a pixel
  cv::Mat depth;   ///< CV_32FC1, m, one measured value of each block (never a mean across an edge); 0 = none
  Camera camera;   ///< of the small images, without distortion: pixels are near enough
  int factor = 4;  ///< full-size pixels a side of a block
};

/// @param gray CV_8UC1; @param depth CV_32FC1 of the same size, m
[[nodiscard]] RgbdView make_rgbd_view(const cv::Mat& gray, const cv::Mat& depth, const Camera& camera,
                                      int factor);

}  // namespace stillpoint
