#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/wide_lanes.hpp"

namespace stillpoint {

/// A pixel that may be a corner.
struct CornerCandidate {
  cv::Point at;    ///< px
  float response;  ///< twice the smaller eigenvalue of its gradient matrix
  bool operator==(const CornerCandidate&) const = default;
};

/// Pixels whose smaller eigenvalue of the 3x3-summed gradient matrix is a local maximum among their eight
/// neighbours; those of the image's outermost pixels count as 0.
/// @param gradients CV_16SC2: the image's Scharr derivatives along x and y; fewer than 2^32 pixels
/// @param quality least response, as a share of the largest one's
/// @param wide eight pixels at once, for processors with AVX2; what it gives is the same to the last bit
/// @return strongest first, those alike in reading order; empty where no response is above 0
[[nodiscard]] std::vector<CornerCandidate> corner_candidates(const cv::Mat& gradients, double quality,
                                                             bool wide = has_wide_lanes());

}  // namespace stillpoint
