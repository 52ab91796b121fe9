#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace stillpoint {

/// How far each feature is believed to stand still, 0 to 1: the weight of its residuals in every pose and in
/// bundle adjustment. A mask takes out what surely moves; what is only suspected, or was never compared,
/// counts less than what was seen to stand still.
/// @param pixels in the full image
/// @param log_odds of moving, CV_32FC1, of a smaller image of the same view; empty: all are trusted
/// @param half log-odds at which a feature counts half
[[nodiscard]] std::vector<float> trust_at(const std::vector<cv::Point2f>& pixels, const cv::Mat& log_odds,
                                          const cv::Size& full, double half);

/// The less of a view is known to stand still, the more of the rest has to be believed, or what little is
/// known of a new or a blurred view decides alone: no kept feature's trust stays below (1 - mean trust)².
/// @param keep one a feature; others neither count nor change
void raise_least_trust(const std::vector<std::uint8_t>& keep, std::vector<float>& trust);

}  // namespace stillpoint
