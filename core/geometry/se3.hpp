#pragma once

#include <Eigen/Geometry>
#include <numbers>
#include <optional>

namespace stillpoint {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A rigid motion. Variables are named by their ends: `world_from_camera` carries points from camera
/// coordinates to world coordinates. Translations are metres.
using Pose = Eigen::Isometry3d;

/// The skew-symmetric matrix of v: hat(v) * w == v.cross(w).
Eigen::Matrix3d hat(const Eigen::Vector3d& v);

/// The exponential map so(3) -> SO(3). `rotation` in radians about its own axis.
Eigen::Matrix3d so3_exp(const Eigen::Vector3d& rotation);

/// The logarithm SO(3) -> so(3), radians, of norm at most pi.
Eigen::Vector3d so3_log(const Eigen::Matrix3d& rotation);

/// The exponential map se(3) -> SE(3). `xi` holds translation (m) first, rotation (rad) second.
Pose se3_exp(const Vector6d& xi);

/// The logarithm SE(3) -> se(3), inverse of se3_exp.
Vector6d se3_log(const Pose& pose);

/// The angle of a rotation, in radians, 0 to pi.
double rotation_angle(const Eigen::Matrix3d& rotation);

/// @param radians an angle
[[nodiscard]] inline double to_degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

/// The pose with its rotation made orthonormal again, after many products.
Pose normalised(const Pose& pose);

/// The rigid motion that a 4x4 matrix of a file is, rounded as files round; nothing where it is none (not
/// finite, sheared, scaled or mirrored by more than 1 %).
[[nodiscard]] std::optional<Pose> rigid_pose(const Eigen::Matrix4d& matrix);

}  // namespace stillpoint
