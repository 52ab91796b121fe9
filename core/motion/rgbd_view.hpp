#pragma once

#include <opencv2/core.hpp>

#include "core/geometry/camera.hpp"
#include "core/wide_lanes.hpp"

namespace stillpoint {

/// A frame made small for judging motion pixel by pixel: what a mask needs, at a sixteenth of the work.
struct RgbdView {
  cv::Mat gray;      ///< CV_32FC1, grey levels, averaged over each block
  cv::Mat gradient;  ///< CV_32FC1, largest difference to a neighbour, grey levels a pixel
  cv::Mat depth;    ///< CV_32FC1, m, one measured value of each block (never a mean across an edge); 0 = none
  cv::Mat surface;  ///< CV_32FC4, what of a pixel is compared with another view's: half the slope of gray
                    ///< sideways and down, grey levels a pixel (two views' halves add up to their mean);
                    ///< gray; and depth, m, 0 unless the four neighbours are measured on the same surface
  cv::Mat
      depth_slope;  ///< CV_32FC1, m a pixel: largest step to one of the four neighbours on the same surface
  Camera camera;    ///< of the downsampled images, without distortion: pixels are near enough
  int factor = 4;   ///< full-size pixels a side of a block
};

/// @param gray CV_8UC1; @param depth CV_32FC1 of the same size, m
/// @param wide by code for processors with AVX2, where blocks have 4 px a side; the view is the same
[[nodiscard]] RgbdView make_rgbd_view(const cv::Mat& gray, const cv::Mat& depth, const Camera& camera,
                                      int factor, bool wide = has_wide_lanes());

/// A small mask (CV_8UC1) at full size, by blocks; what no block covers takes after the nearest.
[[nodiscard]] cv::Mat enlarged(const cv::Mat& small_mask, int factor, const cv::Size& size);

/// Whether two depths (m) that lie side by side belong to one surface.
[[nodiscard]] inline bool same_surface(float a, float b) {
  const float nearer = a < b ? a : b;
  return (a > b ? a - b : b - a) < 0.02F + 0.012F * nearer * nearer;
}

}  // namespace stillpoint
