#pragma once

#include <opencv2/core.hpp>

namespace stillpoint {

/// What ORB's descriptors look at: a level of the pyramid, blurred.
struct BlurredLevel {
  cv::Mat pixels;  // CV_8UC1, with columns to spare
};

/// Blurs a level as cv::ORB does before it describes: a Gaussian of 7x7 px and sigma 2, the level mirrored at
/// its edges; to OpenCV's last bit. Only on processors that can_blur_wide().
/// @param level CV_8UC1, at least 4 px wide and high
void blur_for_orb(const cv::Mat& level, BlurredLevel& blurred);

/// Whether the processor has AVX2 and fused multiplication, with which OpenCV sums where it can, too.
[[nodiscard]] bool can_blur_wide();

}  // namespace stillpoint
