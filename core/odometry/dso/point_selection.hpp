#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/odometry/dso/dso_image.hpp"

namespace stillpoint {

/// A pixel that may become a point.
struct DsoCandidate {
  int x = 0, y = 0;
  int level = 0;  ///< pyramid level whose gradient chose it
};

/// The gradient (grey levels a pixel) a candidate must exceed, one value a block of 32x32 px: the block's
/// median gradient + margin, averaged over 3x3 blocks.
[[nodiscard]] cv::Mat gradient_thresholds(const DsoImage& image, double margin);

/// One pass: of each cell of d px the steepest pixel above its block's threshold; where a cell of 2d has
/// none, its steepest at the next level above 0.75 of it; likewise 4d with 0.75².
/// @param usable CV_8UC1 of the image's size, 0 = no candidate; empty: all
[[nodiscard]] std::vector<DsoCandidate> select_in_cells(const DsoImage& image, const cv::Mat& thresholds,
                                                        const cv::Mat& usable, int d);

/// With d adapted so that about `wanted` are found. @param d of the last keyframe; becomes the next one's
[[nodiscard]] std::vector<DsoCandidate> select_candidates(const DsoImage& image, const cv::Mat& thresholds,
                                                          const cv::Mat& usable, int wanted, int& d);

}  // namespace stillpoint
