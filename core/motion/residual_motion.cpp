#include "core/motion/residual_motion.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geometry/pixel_conventions.hpp"
#include "core/motion/rgbd_view.hpp"

namespace stillpoint {

PixelRays::PixelRays(const Camera& camera, const cv::Size& frame, int factor)
    : size_(std::max(1, frame.width / factor), std::max(1, frame.height / factor)) {
  const Camera full = camera.scaled_to(frame.width, frame.height);
  fx_ = full.fx, fy_ = full.fy;
  focal_x_ = static_cast<float>(full.fx / factor), focal_y_ = static_cast<float>(full.fy / factor);
  centre_x_ = static_cast<float>(downsampled(full.cx, factor));
  centre_y_ = static_cast<float>(downsampled(full.cy, factor));
  if (!full.has_distortion()) return;
  table_.create(size_, CV_32FC2);
  std::vector<cv::Point2f> row(static_cast<std::size_t>(size_.width));
  for (int y = 0; y < size_.height; ++y) {
    for (int x = 0; x < size_.width; ++x)
      row[static_cast<std::size_t>(x)] = {static_cast<float>(upsampled(static_cast<double>(x), factor)),
                                          static_cast<float>(upsampled(static_cast<double>(y), factor))};
    const std::vector<cv::Point2f> straight = full.undistort(row);
    auto* out = table_.ptr<cv::Vec2f>(y);
    for (int x = 0; x < size_.width; ++x) {
      const cv::Point2f& p = straight[static_cast<std::size_t>(x)];
      out[x] = {static_cast<float>((static_cast<double>(p.x) - full.cx) / full.fx),
                static_cast<float>((static_cast<double>(p.y) - full.cy) / full.fy)};
    }
  }
}

Eigen::Vector2f PixelRays::at(float x, float y) const {
  if (table_.empty()) return {(x - centre_x_) / focal_x_, (y - centre_y_) / focal_y_};
  const int left = std::clamp(static_cast<int>(std::floor(x)), 0, std::max(0, size_.width - 2));
  const int top = std::clamp(static_cast<int>(std::floor(y)), 0, std::max(0, size_.height - 2));
  const int right = std::min(left + 1, size_.width - 1), bottom = std::min(top + 1, size_.height - 1);
  const float a = x - static_cast<float>(left), b = y - static_cast<float>(top);
  const auto *upper = table_.ptr<cv::Vec2f>(top), *lower = table_.ptr<cv::Vec2f>(bottom);
  const cv::Vec2f ray = (upper[left] * (1.0F - a) + upper[right] * a) * (1.0F - b) +
                        (lower[left] * (1.0F - a) + lower[right] * a) * b;
  return {ray[0], ray[1]};
}

float ResidualMotion::chi_squared() const {
  // By the inverse's cofactors: three by three, and positive definite by its noise.
  const Eigen::Matrix3f& s = covariance;
  const float c00 = s(1, 1) * s(2, 2) - s(1, 2) * s(1, 2), c01 = s(0, 2) * s(1, 2) - s(0, 1) * s(2, 2),
              c02 = s(0, 1) * s(1, 2) - s(0, 2) * s(1, 1), c11 = s(0, 0) * s(2, 2) - s(0, 2) * s(0, 2),
              c12 = s(0, 1) * s(0, 2) - s(0, 0) * s(1, 2), c22 = s(0, 0) * s(1, 1) - s(0, 1) * s(0, 1);
  const float determinant = s(0, 0) * c00 + s(0, 1) * c01 + s(0, 2) * c02;
  const float x = motion.x(), y = motion.y(), z = motion.z();
  return (x * x * c00 + y * y * c11 + z * z * c22 + 2.0F * (x * y * c01 + x * z * c02 + y * z * c12)) /
         determinant;
}

float ResidualMotion::sigma() const {
  const float squared = motion.squaredNorm();
  if (squared <= 0.0F) return std::sqrt(covariance.trace() / 3.0F);
  return std::sqrt(motion.dot(covariance * motion) / squared);
}

CameraMotion::CameraMotion(const Pose& here_from_last, const Matrix6d& pose_covariance)
    : rotation(here_from_last.linear().cast<float>()),
      translation(here_from_last.translation().cast<float>()),
      covariance(pose_covariance.cast<float>()) {}

Eigen::Matrix3f point_covariance(const Eigen::Vector2f& ray, float z, const SceneFlowNoise& noise) {
  // X = (x z, y z, z): dX/dx = (z, 0, 0), dX/dy = (0, z, 0), dX/dz = (x, y, 1).
  const Eigen::Vector3f by_depth(ray.x(), ray.y(), 1.0F);
  const auto growing = static_cast<float>(noise.depth_per_m2) * z * z,
             floor = static_cast<float>(noise.depth_floor);
  const float across = static_cast<float>(noise.ray_x) * z, down = static_cast<float>(noise.ray_y) * z;
  Eigen::Matrix3f covariance = (growing * growing + floor * floor) * by_depth * by_depth.transpose();
  covariance(0, 0) += across * across;
  covariance(1, 1) += down * down;
  return covariance;
}

ResidualMotion residual_motion(const ScenePair& pair, const CameraMotion& camera,
                               const SceneFlowNoise& noise) {
  const Eigen::Vector3f here(pair.ray_here.x() * pair.z_here, pair.ray_here.y() * pair.z_here, pair.z_here);
  const Eigen::Vector3f last(pair.ray_last.x() * pair.z_last, pair.ray_last.y() * pair.z_last, pair.z_last);
  const Eigen::Vector3f carried = camera.rotation * last + camera.translation;
  ResidualMotion residual;
  residual.motion = here - carried;
  // exp(δ) moves what is carried by ρ + φ x carried, so that dM/dδ = [-I, hat(carried)].
  Eigen::Matrix3f turned;
  turned << 0.0F, -carried.z(), carried.y(), carried.z(), 0.0F, -carried.x(), -carried.y(), carried.x(), 0.0F;
  const Eigen::Matrix3f tt = camera.covariance.topLeftCorner<3, 3>(),
                        tr = camera.covariance.topRightCorner<3, 3>(),
                        rr = camera.covariance.bottomRightCorner<3, 3>();
  const Eigen::Matrix3f cross = tr * turned.transpose();
  residual.covariance =
      point_covariance(pair.ray_here, pair.z_here, noise) +
      camera.rotation * point_covariance(pair.ray_last, pair.z_last, noise) * camera.rotation.transpose() +
      tt - cross - cross.transpose() + turned * rr * turned.transpose();
  return residual;
}

float surface_depth(const cv::Mat& depth, float x, float y) {
  const int column = cvRound(x), row = cvRound(y);
  if (column < 1 || row < 1 || column + 1 >= depth.cols || row + 1 >= depth.rows) return 0.0F;
  const auto *above = depth.ptr<float>(row - 1), *here = depth.ptr<float>(row),
             *below = depth.ptr<float>(row + 1);
  const float z = here[column];
  if (!(z > 0.0F)) return 0.0F;
  for (const float other : {here[column - 1], here[column + 1], above[column], below[column]})
    if (!(other > 0.0F) || !same_surface(z, other)) return 0.0F;
  return z;
}

}  // namespace stillpoint
