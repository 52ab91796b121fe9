#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "core/wide_lanes.hpp"

namespace stillpoint {

/// Pixels by grey level.
using Histogram = std::array<int, 256>;

/// Eq. (1): |destination − compensated| where `valid`, 0 elsewhere. All CV_8UC1 of one size.
/// @param wide 32 pixels at once, for processors with AVX2; the result is the same, here and below
[[nodiscard]] cv::Mat frame_difference(const cv::Mat& destination, const cv::Mat& compensated,
                                       const cv::Mat& valid, bool wide = has_wide_lanes());

/// By how much `destination` is brighter than `compensated`, as a factor: the median over `valid` pixels that
/// are neither dark nor near white. 1 where it is within 2 % of 1, which noise and dynamic objects reach, or
/// where fewer than a tenth of the pixels tell. All CV_8UC1 of one size.
[[nodiscard]] double exposure_ratio(const cv::Mat& destination, const cv::Mat& compensated,
                                    const cv::Mat& valid, bool wide = has_wide_lanes());

/// The grey levels of `image` where `valid` is 255, and not 0. Both CV_8UC1 of one size.
[[nodiscard]] Histogram histogram(const cv::Mat& image, const cv::Mat& valid);

/// Otsu's threshold: the level th for which the pixels up to th and those above it lie furthest apart
/// (largest between-class variance; the lowest such level of several). It splits whatever it is given, also
/// the noise of a frame in which nothing moves. 0 for pixels of one level only.
[[nodiscard]] int otsu_threshold(const Histogram& levels);

/// Eq. (2): 255 where the difference is above the threshold, else 0.
[[nodiscard]] cv::Mat binarise(const cv::Mat& difference, double threshold, bool wide = has_wide_lanes());

}  // namespace stillpoint
