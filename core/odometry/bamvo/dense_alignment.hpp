#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/odometry/bamvo/bamvo_config.hpp"

namespace stillpoint {

/// One frame at one size, ready to be aligned.
struct DenseView {
  cv::Mat gray;    ///< CV_32FC1, brightness 0 to 1
  cv::Mat depth;   ///< CV_32FC1, m, 0 = none
  cv::Mat weight;  ///< CV_32FC1 of each pixel; empty: 1
  Camera camera;   ///< of this size, without distortion
};

/// @param gray CV_8UC1; @param factor full-size pixels a side: brightness is averaged, and depth of one
/// surface
[[nodiscard]] DenseView make_dense_view(const cv::Mat& gray, const cv::Mat& depth, const Camera& camera,
                                        int factor);
/// Of each block of `factor` pixels a side one value of a CV_32FC1 image: never a mean across an edge.
[[nodiscard]] cv::Mat picked(const cv::Mat& image, int factor);
/// Of each block the mean depth of what lies on the surface of its middle; 0 where that has none.
[[nodiscard]] cv::Mat averaged_depth(const cv::Mat& depth, int factor);
/// The same at half its size.
[[nodiscard]] DenseView halved(const DenseView& view);

struct DenseAlignment {
  Pose target_from_reference = Pose::Identity();
  int iterations = 0;
  int counted = 0;                 ///< pixels that count at the finest level
  double mean = 0.0, sigma = 0.0;  ///< of residuals, brightness 0 to 1, at the finest level
  cv::Mat residual, weight;        ///< CV_32FC1 in the reference's pixels, finest level; NaN: does not count
  std::string failure;             ///< empty when it is to be believed
};

/// Kim & Kim's weighted dense alignment: brightness of every pixel of the reference with depth against where
/// it is warped to, by Gauss-Newton over se(3) with background weight times Student's t, coarse to fine.
/// @param reference finest first: levels, whose weights are the background model's; @param target likewise
[[nodiscard]] DenseAlignment align_dense(const std::vector<DenseView>& reference,
                                         const std::vector<DenseView>& target, const Pose& start,
                                         const BamvoConfig& config, int threads);

}  // namespace stillpoint
