#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace stillpoint {

/// What ORB's descriptors look at: a level of the pyramid, blurred.
struct BlurredLevel {
  std::vector<std::uint8_t> pixels;
  int step = 0;  // px from row to row

  [[nodiscard]] const std::uint8_t* at(int x, int y) const {
    return pixels.data() + static_cast<std::ptrdiff_t>(y) * step + x;
  }
};

/// Blurs a level as cv::ORB does before it describes: a Gaussian of 7x7 px and sigma 2, the level mirrored at
/// its edges; to OpenCV's last bit. Only on processors that can_blur_wide().
/// @param level CV_8UC1, at least 4 px wide and high
void blur_for_orb(const cv::Mat& level, BlurredLevel& blurred);

/// Whether the processor has AVX2 and fused multiplication, with which OpenCV sums where it can, too.
[[nodiscard]] bool can_blur_wide();

}  // namespace stillpoint
