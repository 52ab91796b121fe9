#pragma once

#include <opencv2/core.hpp>

namespace stillpoint {

/// A frame carried into another camera.
struct CompensatedFrame {
  cv::Mat image;  ///< CV_8UC1, bilinear, 0 where the source has no data
  cv::Mat valid;  ///< CV_8UC1: 255 where the source has data at least the border margin inside its edge
};

/// METHOD.md §1 step 3: every pixel of `source` carried by H into an image of the same size.
/// @param homography destination from source, invertible
/// @param border_px source pixels beside its edge that count as having no data
[[nodiscard]] CompensatedFrame compensate(const cv::Mat& source, const cv::Matx33d& homography,
                                          int border_px);

/// Where the warp has data: 255 for the pixels that H⁻¹ carries `border_px` or more inside the source's edge.
[[nodiscard]] cv::Mat valid_area(const cv::Size& size, const cv::Matx33d& homography, int border_px);

/// A mask carried by H into another camera: nearest pixel, 0 where there is no data.
[[nodiscard]] cv::Mat warp_mask(const cv::Mat& mask, const cv::Matx33d& homography);

}  // namespace stillpoint
