#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/motion/gao2019/gao2019_config.hpp"

namespace stillpoint {

// The first pose of method `gao2019`: sparse image alignment of small patches between the last frame and this
// one.

/// Side of a patch, px of its level.
inline constexpr int kPatchSide = 4;

/// A corner with depth.
struct AlignmentPoint {
  cv::Point2f pixel;      ///< px, in the image as it is
  Eigen::Vector3d point;  ///< m, in the frame's own camera
};

/// The image, and each half the one before: CV_8UC1.
using AlignmentPyramid = std::vector<cv::Mat>;
[[nodiscard]] AlignmentPyramid alignment_pyramid(const cv::Mat& gray, int coarsest_level);

/// At most one point a cell: its strongest FAST corner, where it has depth within one surface.
/// @param gray CV_8UC1 @param depth CV_32FC1, m; empty: there are no points @param camera of the image's size
[[nodiscard]] std::vector<AlignmentPoint> corner_points(const cv::Mat& gray, const cv::Mat& depth,
                                                        const Camera& camera, const Gao2019Config& config);

struct SparseAlignment {
  bool found = false;
  Pose here_from_last = Pose::Identity();
  int patches = 0;                ///< of the last frame
  int in_view = 0;                ///< of those, the ones that this frame shows
  double sigma = 0.0;             ///< grey levels: of the residuals at the finest level, by their median
  int iterations = 0;             ///< on all levels
  std::vector<cv::Point2f> here;  ///< px: where each patch lies in this frame; NaN where it is not in view
  std::string note;               ///< why it was not found; empty when it was
};

/// Minimises the differences of brightness of 4x4 patches over the motion between two frames, coarse to fine:
/// inverse compositional Gauss-Newton (Forster et al. 2014), Student's t weights, the images' common offset
/// taken off.
/// @param points of the last frame
[[nodiscard]] SparseAlignment align_sparsely(const AlignmentPyramid& last,
                                             const std::vector<AlignmentPoint>& points,
                                             const AlignmentPyramid& here, const Pose& start,
                                             const Camera& camera, const Gao2019Config& config);

}  // namespace stillpoint
