#include "core/motion/feature_pose.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/normal_equations.hpp"

namespace stillpoint {
namespace {

constexpr int kLeast = 12;              // inliers: fewer make no pose to rely on
constexpr int kHuber = 6, kHard = 4;    // steps with Huber's weights, then with inliers alone
constexpr double kHuberSigmas = 1.345;  // 95 % as efficient as least squares on Gaussian errors
constexpr double kGate = 5.991;         // χ² of two degrees of freedom, 95 %
constexpr double kNearest = 0.05;       // m: nearer points are not projected

struct Seen {
  std::size_t feature;
  Eigen::Vector3d world;
  Eigen::Vector2d pixel;  // undistorted
};

std::vector<Seen> seen_points(std::span<const MotionFeature> features, std::span<const std::uint8_t> left_out,
                              const Camera& camera) {
  std::vector<cv::Point2f> pixels;
  std::vector<Seen> seen;
  for (std::size_t i = 0; i < features.size(); ++i)
    if (features[i].map_point >= 0 && (left_out.empty() || left_out[i] == 0)) {
      pixels.push_back(features[i].pixel);
      seen.push_back({i, features[i].world, Eigen::Vector2d::Zero()});
    }
  if (pixels.empty()) return seen;
  const std::vector<cv::Point2f> straight = camera.undistort(pixels);
  for (std::size_t i = 0; i < seen.size(); ++i)
    seen[i].pixel = {static_cast<double>(straight[i].x), static_cast<double>(straight[i].y)};
  return seen;
}

/// Squared reprojection errors, px²; infinite behind the camera.
std::vector<double> squared_errors(const std::vector<Seen>& seen, const Pose& pose, const Camera& camera) {
  std::vector<double> squared;
  squared.reserve(seen.size());
  for (const Seen& one : seen) {
    const Eigen::Vector3d p = pose * one.world;
    squared.push_back(p.z() < kNearest ? std::numeric_limits<double>::infinity()
                                       : (one.pixel - camera.project(p)).squaredNorm());
  }
  return squared;
}

/// Of one coordinate, by the median squared error of both: χ² of two degrees of freedom has its median
/// at 1.386.
double sigma_of(std::vector<double> squared, double least) {
  const auto middle = squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2);
  std::nth_element(squared.begin(), middle, squared.end());
  return std::max(least, std::sqrt(*middle / 1.386));
}

}  // namespace

FeaturePose pose_of_features(std::span<const MotionFeature> features, std::span<const std::uint8_t> left_out,
                             const Pose& start, const Camera& camera, double least_sigma_px) {
  FeaturePose result;
  result.camera_from_world = start;
  const std::vector<Seen> seen = seen_points(features, left_out, camera);
  result.used = static_cast<int>(seen.size());
  if (result.used < kLeast) return result;
  Matrix6d hessian;
  for (int step = 0; step < kHuber + kHard; ++step) {
    const std::vector<double> squared = squared_errors(seen, result.camera_from_world, camera);
    const double sigma = sigma_of(squared, least_sigma_px);
    if (!std::isfinite(sigma)) return result;
    hessian.setZero();
    Vector6d gradient = Vector6d::Zero();
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const double off = squared[i] / (sigma * sigma);
      if (step >= kHuber ? off > kGate : !std::isfinite(off)) continue;
      const double weight =
          step >= kHuber ? 1.0 : std::min(1.0, kHuberSigmas / std::sqrt(std::max(off, 1e-12)));
      const Eigen::Vector3d p = result.camera_from_world * seen[i].world;
      const double inverse = 1.0 / p.z();
      Eigen::Matrix<double, 2, 3> by_point;
      by_point << camera.fx * inverse, 0.0, -camera.fx * p.x() * inverse * inverse, 0.0, camera.fy * inverse,
          -camera.fy * p.y() * inverse * inverse;
      Eigen::Matrix<double, 2, 6> by_pose;
      by_pose << by_point, -by_point * hat(p);
      hessian += weight * by_pose.transpose() * by_pose;
      gradient += weight * by_pose.transpose() * (seen[i].pixel - camera.project(p));
    }
    const std::optional<Vector6d> change = try_solve_ldlt<6>(hessian, gradient);
    if (!change) return result;
    result.camera_from_world = normalised(se3_exp(*change) * result.camera_from_world);
  }
  const std::vector<double> squared = squared_errors(seen, result.camera_from_world, camera);
  result.sigma_px = sigma_of(squared, least_sigma_px);
  const double gate = kGate * result.sigma_px * result.sigma_px;
  std::vector<std::uint8_t> is_inlier(features.size(), 0);
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (squared[i] <= gate) is_inlier[seen[i].feature] = 1, ++result.inliers;
  result.found = result.inliers >= kLeast;
  if (result.found) {
    result.is_inlier = std::move(is_inlier);
    result.covariance = hessian.inverse() * (result.sigma_px * result.sigma_px);
  } else {
    result.camera_from_world = start;
  }
  return result;
}

}  // namespace stillpoint
