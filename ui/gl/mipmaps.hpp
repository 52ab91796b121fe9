#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace stillpoint {

/// An image at half its size and half of that, as far as sides can be halved: what a texture that is drawn
/// smaller is read from. Each pixel is the mean of four, rounded as Mesa's software rasteriser does, so that
/// pictures do not depend on who halves.
/// @param image CV_8U or CV_32F of 1, 3 or 4 channels
/// @returns the largest first; nothing where sides become odd too soon for a texture to do without the rest
[[nodiscard]] std::vector<cv::Mat> halved_levels(const cv::Mat& image);

}  // namespace stillpoint
