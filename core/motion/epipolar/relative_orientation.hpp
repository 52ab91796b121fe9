#pragma once

#include <Eigen/Core>
#include <span>

namespace stillpoint {

/// A point seen from two places: bearings (x, y, 1), that is, undistorted pixels less the principal point by
/// the focal length.
struct BearingPair {
  Eigen::Vector3d now, then;
  double weight = 1.0;        ///< probability that it is static, times its share of the image
  double after_middle = 0.0;  ///< s after its frame's middle row that `now` was seen; of a rolling shutter
};

/// The camera's motion between two frames as images alone tell it: then ~ rotation * now + translation /
/// depth, the translation a direction only.
struct RelativeOrientation {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< of length 1; of no meaning when rotation_only
  bool rotation_only = false;  ///< rotation alone explains what is static: there is no parallax
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();  ///< rad / s: turning that `now` has not been freed of yet
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< of rotation and rate
  double explained = 0.0;  ///< weighted share of the pairs within a few sigma of the motion, 0 to 1
};

struct RelativeOrientationOptions {
  double sigma = 1e-3;               ///< noise of a bearing, in units of the focal length
  double least_sigma = 4e-4;         ///< the same at its best, by which parallax is told from noise
  double rate_sigma = 0.0;           ///< rad / s: how far the rate may be off; 0 = not at all
  int samples = 60;                  ///< directions tried
  double rotation_only_share = 0.6;  ///< so many must agree with rotation alone …
  double between_share = 0.12;       ///< … and at most so many may disagree by little, as parallax does
};

/// Robust rotation alone, then ~ rotation * now: that of most of the picture. Deterministic.
[[nodiscard]] Eigen::Matrix3d estimate_rotation(std::span<const BearingPair> pairs, double sigma);

/// Robust (Geman-McClure, annealed) rotation and direction of translation, and of a rolling shutter the rate
/// it turns at: Gauss-Newton on the Sampson distance, and on how far places lie behind infinity, from the
/// best of many directions through two points each. Deterministic.
/// @param hint a direction to begin with as well, or null
[[nodiscard]] RelativeOrientation estimate_relative_orientation(std::span<const BearingPair> pairs,
                                                                const RelativeOrientationOptions& options,
                                                                const RelativeOrientation* hint = nullptr);

/// How far `then` lies off what the camera's motion allows, in units of the focal length: off the rotation
/// where the camera only turned; else off the epipolar line, or, along it, beyond the point at infinity by
/// more than `tolerance`.
[[nodiscard]] Eigen::Vector2d epipolar_residual(const RelativeOrientation& motion, const BearingPair& pair,
                                                double tolerance);

/// Parallax along the epipolar line, in units of the focal length: positive before the camera, zero at
/// infinity.
/// @param sigma set to what the uncertainty of rotation and rate makes of it, one standard deviation
[[nodiscard]] double nearness(const RelativeOrientation& motion, const BearingPair& pair, double& sigma);

/// Signed distance off the epipolar line, to first order (Sampson), in units of the focal length.
[[nodiscard]] double sampson_distance(const RelativeOrientation& motion, const BearingPair& pair);

/// Shift of a pair beside the rotation, in units of the focal length: `then` less where rotation alone puts
/// it.
[[nodiscard]] Eigen::Vector2d parallax(const RelativeOrientation& motion, const BearingPair& pair);

}  // namespace stillpoint
