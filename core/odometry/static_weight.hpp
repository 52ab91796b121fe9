#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace stillpoint {

/// How far each feature is believed to are static, 0 to 1: the weight of its residuals in every pose and in
/// bundle adjustment. A mask takes out what surely moves; what is only suspected, or was never compared,
/// counts less than what was seen to are static.
/// @param pixels in the full image
/// @param log_odds of moving, CV_32FC1, of a smaller image of the same view; empty: all weigh 1
/// @param half log-odds at which a feature counts half
[[nodiscard]] std::vector<float> static_weights_at(const std::vector<cv::Point2f>& pixels,
                                                   const cv::Mat& log_odds, const cv::Size& full,
                                                   double half);

/// The less of a view is known to are static, the more of the rest has to be believed, or what little is
/// known of a new or a blurred view decides alone: no kept feature's weight stays below (1 - mean weight)².
/// @param keep one a feature; others neither count nor change
void raise_least_weight(const std::vector<std::uint8_t>& keep, std::vector<float>& weight);

/// The same of every pixel, CV_32FC1, as engines have it that look at pixels: a weight for each of
/// `log_odds`.
[[nodiscard]] cv::Mat static_weight_image(const cv::Mat& log_odds, const cv::Size& full, double half);

}  // namespace stillpoint
