#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.hpp"

namespace stillpoint {

/// Depth of a depth camera as the colour camera beside it would have measured it.
///
/// The depth image is warped forward as a surface: each cell of four neighbouring pixels whose depths go on
/// into one another is drawn as two triangles, with inverse depth linear across them, as it is on a plane.
/// So nothing is left open between the pixels where the colour image is the larger one. Beside a step in
/// depth there is no surface; there, a pixel covers the square it has in the depth image, as far as nothing
/// else does. Of surfaces that fall together the nearest is kept (a z-buffer).
///
/// Both cameras' distortion is minded: what comes out lies in the colour image as it is stored.
class DepthRegistration {
 public:
  /// @param colour of the images that depth is registered to; its width and height are the result's
  DepthRegistration(const DepthCamera& depth, const Camera& colour);

  /// What depth images must be.
  [[nodiscard]] cv::Size depth_size() const { return {depth_.camera.width, depth_.camera.height}; }

  /// @param depth CV_32FC1 of depth_size, m, 0 = no measurement
  /// @returns CV_32FC1 of the colour image's size, m along the colour camera's axis, 0 = no measurement
  [[nodiscard]] cv::Mat registered(const cv::Mat& depth) const;

 private:
  DepthCamera depth_;
  Camera colour_;
  /// Directions of the depth pixels' corners, (width + 1) x (height + 1), and of their centres, z = 1, in
  /// the depth camera's frame, without distortion.
  std::vector<Eigen::Vector3d> corners_, centres_;
};

}  // namespace stillpoint
