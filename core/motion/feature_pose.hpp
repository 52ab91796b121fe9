#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/motion/motion_method.hpp"

namespace stillpoint {

/// The camera's pose from those of a frame's features that a method has not taken out, and how sure it is.
/// Methods that solve the pose again between two rounds of judging share it; the run's pose is the
/// odometry's.
struct FeaturePose {
  bool found = false;  ///< enough features agree
  Pose camera_from_world = Pose::Identity();
  /// Inverse Hessian of the reprojection errors: of a perturbation exp(δ) camera_from_world, translation (m)
  /// first, then rotation (rad). Zero where the pose was not found.
  Matrix6d covariance = Matrix6d::Zero();
  int used = 0;     ///< features that have a map point and are not left out
  int inliers = 0;  ///< of those, within the gate at the end
  std::vector<std::uint8_t>
      is_inlier;          ///< one a feature: 1 where it is among these; empty where the pose was not found
  double sigma_px = 0.0;  ///< standard deviation of a reprojection error, by the median
};

/// Gauss-Newton on reprojection errors from `start`, Huber weights first and then the inliers alone; noise by
/// the median error, at least `least_sigma_px`. Deterministic.
/// @param left_out one a feature, non-zero = not used; empty = all are used
/// @param camera of the frame's size
[[nodiscard]] FeaturePose pose_of_features(std::span<const MotionFeature> features,
                                           std::span<const std::uint8_t> left_out, const Pose& start,
                                           const Camera& camera, double least_sigma_px = 0.5);

}  // namespace stillpoint
