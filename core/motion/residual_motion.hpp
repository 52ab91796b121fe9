#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"

namespace stillpoint {

// What is left of a point's motion in space once the camera's own is taken off, and how far noise alone may
// bring it. Methods that test scene flow share it. (Alcantarilla et al., ICRA 2012.)

/// Rays of an image's pixels, lens distortion undone. The ray of a pixel is (x, y, 1): at depth z it sees (x
/// z, y z, z).
class PixelRays {
 public:
  PixelRays() = default;
  /// @param frame px, the size of the full image; `camera` is scaled to it
  /// @param factor full-size pixels a side of one of the downsampled image's, whose pixels at() is asked for
  PixelRays(const Camera& camera, const cv::Size& frame, int factor);

  /// x and y of the ray of a place of the downsampled image, px; between pixels bilinear.
  [[nodiscard]] Eigen::Vector2f at(float x, float y) const;
  [[nodiscard]] const cv::Size& size() const { return size_; }  ///< of the downsampled image
  /// Focal lengths of the full image, px.
  [[nodiscard]] double fx() const { return fx_; }
  [[nodiscard]] double fy() const { return fy_; }

 private:
  cv::Size size_;
  double fx_ = 1.0, fy_ = 1.0;
  float focal_x_ = 1.0F, focal_y_ = 1.0F, centre_x_ = 0.0F, centre_y_ = 0.0F;  // of the downsampled image
  cv::Mat table_;  // CV_32FC2, size_; empty where there is no distortion
};

/// Noise of what is measured.
struct SceneFlowNoise {
  double ray_x = 0.0,
         ray_y = 0.0;  ///< standard deviation of a ray's x and y: px of the full image over focal length
  double depth_per_m2 = 0.0;  ///< 1/m: of a depth z, a part that grows as depth_per_m2 · z², m …
  double depth_floor = 0.0;   ///< m: … and one that does not; their squares add up
};

/// A point seen in the last frame and in this one.
struct ScenePair {
  Eigen::Vector2f ray_last = Eigen::Vector2f::Zero(), ray_here = Eigen::Vector2f::Zero();
  float z_last = 0.0F, z_here = 0.0F;  ///< m
};

/// M = X'(x', z') - (R X(x, z) + t) and its covariance J S Jᵀ, in this frame's camera.
struct ResidualMotion {
  Eigen::Vector3f motion = Eigen::Vector3f::Zero();      ///< m
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();  ///< m²

  /// Mᵀ Σ⁻¹ M: χ² with three degrees of freedom for what is static.
  [[nodiscard]] float chi_squared() const;
  /// Standard deviation along the motion itself, m.
  [[nodiscard]] float sigma() const;
};

/// The camera's motion and how sure it is, as pairs are tested by it.
struct CameraMotion {
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();  ///< here from last
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();   ///< m
  /// Of a perturbation from the left, exp(δ) here_from_last, translation first; zero = exact.
  Eigen::Matrix<float, 6, 6> covariance = Eigen::Matrix<float, 6, 6>::Zero();

  CameraMotion() = default;
  explicit CameraMotion(const Pose& here_from_last, const Matrix6d& pose_covariance = Matrix6d::Zero());
};

/// Covariance of the point that a ray sees at depth z: of its ray's x and y, and of z.
[[nodiscard]] Eigen::Matrix3f point_covariance(const Eigen::Vector2f& ray, float z,
                                               const SceneFlowNoise& noise);

[[nodiscard]] ResidualMotion residual_motion(const ScenePair& pair, const CameraMotion& camera,
                                             const SceneFlowNoise& noise);

/// Depth at a place between pixels, m, by the pixel nearest to it; 0 where it or a neighbour has none, or
/// where they do not all lie on one surface. @param depth CV_32FC1, m
[[nodiscard]] float surface_depth(const cv::Mat& depth, float x, float y);

}  // namespace stillpoint
