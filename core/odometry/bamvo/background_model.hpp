#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/odometry/bamvo/bamvo_config.hpp"

namespace stillpoint {

/// A depth image of the past, and where it was taken.
struct PastDepth {
  cv::Mat depth;  ///< CV_32FC1, m, 0 = none
  Pose camera_from_world = Pose::Identity();
};

/// Kim & Kim's nonparametric background model, in the camera of the newest of the depth images.
struct BackgroundModel {
  cv::Mat density;     ///< CV_32FC1, 1/m: high where past depths agree; 0 where nothing is known
  cv::Mat weight;      ///< CV_32FC1: the density as it weighs pixels, by depth and smoothed
  cv::Mat foreground;  ///< CV_8UC1, 255 = its depth changes too much to be background
  cv::Mat median_m;    ///< CV_32FC1, m: median change of depth; NaN where there is none to compare
  cv::Mat compared;    ///< CV_8UC1: how many past images showed the pixel
};

/// The density below which a pixel is foreground: that of one whose median change is `change_m`,
/// 0.6744 exp(-0.4548) / (sqrt(pi) change).
[[nodiscard]] double foreground_density(double change_m);

/// B(x) = 1/(K sqrt(2 pi) sigma) sum_k exp(-change_k^2 / (2 sigma^2)) of the K changes of a pixel's depth,
/// with sigma = median change / (0.6744 sqrt 2).
/// @param changes m, at least one; sorted in place @param median m, of them
[[nodiscard]] double background_density(std::vector<float>& changes, double least_sigma_m, double& median);

/// A past depth image as the newest camera would have measured it: points splatted, the nearest kept.
[[nodiscard]] cv::Mat warped_depth(const cv::Mat& depth, const Camera& camera, const Pose& now_from_then);

/// @param past newest last, all of one size, which is the camera's; one alone gives density 1 wherever depth
/// is in range
[[nodiscard]] BackgroundModel model_background(const std::vector<PastDepth>& past, const Camera& camera,
                                               const BamvoConfig& config);

}  // namespace stillpoint
