#include "core/geometry/se3.hpp"

#include <cmath>

namespace stillpoint {
namespace {

constexpr double kSmallAngle = 1e-5;  // rad; below it the series' next term is under double's resolution

/// The matrix V of SE(3)'s exponential: translation = V * rho.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  const Eigen::Matrix3d w = hat(rotation);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + 0.5 * w + w * w / 6.0;
  const double angle2 = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / angle2 * w +
         (angle - std::sin(angle)) / (angle2 * angle) * w * w;
}

}  // namespace

Eigen::Matrix3d hat(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d so3_exp(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  const Eigen::Matrix3d w = hat(rotation);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + w + 0.5 * w * w;
  return Eigen::Matrix3d::Identity() + std::sin(angle) / angle * w +
         (1.0 - std::cos(angle)) / (angle * angle) * w * w;
}

Eigen::Vector3d so3_log(const Eigen::Matrix3d& rotation) {
  // Through the quaternion: stable near 0 and near pi alike.
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < kSmallAngle) return 2.0 * q.vec() / q.w();
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

Pose se3_exp(const Vector6d& xi) {
  Pose pose = Pose::Identity();
  pose.linear() = so3_exp(xi.tail<3>());
  pose.translation() = left_jacobian(xi.tail<3>()) * xi.head<3>();
  return pose;
}

Vector6d se3_log(const Pose& pose) {
  Vector6d xi;
  xi.tail<3>() = so3_log(pose.linear());
  const Eigen::Vector3d rotation = xi.tail<3>();
  xi.head<3>() = left_jacobian(rotation).partialPivLu().solve(pose.translation());
  return xi;
}

double rotation_angle(const Eigen::Matrix3d& rotation) { return so3_log(rotation).norm(); }

Pose normalised(const Pose& pose) {
  Pose result = Pose::Identity();
  result.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
  result.translation() = pose.translation();
  return result;
}

std::optional<Pose> rigid_pose(const Eigen::Matrix4d& matrix) {
  constexpr double kRounding = 1e-2;  // of a matrix's numbers: what printing few digits leaves
  const Eigen::Matrix3d turn = matrix.topLeftCorner<3, 3>();
  if (!matrix.allFinite() || !(turn * turn.transpose()).isIdentity(kRounding) || turn.determinant() < 0 ||
      (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > kRounding)
    return std::nullopt;
  Pose pose = Pose::Identity();
  pose.linear() = turn;
  pose.translation() = matrix.topRightCorner<3, 1>();
  return normalised(pose);
}

}  // namespace stillpoint
