#pragma once

#include <opencv2/core.hpp>

namespace stillpoint {

/// Where a mask ends, as colours tell: each of the pixels in doubt goes with those of the same colours,
/// either of what surely belongs to the mask or of what lies about it. (The colour term of GrabCut, Rother et
/// al. 2004, with histograms and without its cuts.)
/// @param image CV_8UC3 or CV_8UC1 @param sure, maybe CV_8UC1 of its size, 255 = in; `maybe` holds `sure`
/// @param reach px: so far about `maybe` lies what is compared with
/// @return CV_8UC1: `sure`, and what of `maybe` goes with it
[[nodiscard]] cv::Mat settle_outline(const cv::Mat& image, const cv::Mat& sure, const cv::Mat& maybe,
                                     int reach);

}  // namespace stillpoint
