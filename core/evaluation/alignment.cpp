#include "core/evaluation/alignment.hpp"

#include <algorithm>

#include "core/geometry/rotation_fit.hpp"

namespace stillpoint {
namespace {

// Second singular value of the positions' cross-covariance against the first, below which they lie on a line.
constexpr double kLineRatio = 1e-10;

Eigen::Matrix3Xd positions(std::size_t count, const PoseAt& poses) {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(count));
  for (Eigen::Index i = 0; i < result.cols(); ++i)
    result.col(i) = poses(static_cast<std::size_t>(i)).translation();
  return result;
}

/// The rotation that turns the estimate's orientations into the truth's with the least sum of squared chords.
Eigen::Matrix3d mean_rotation(std::size_t count, const PoseAt& estimate, const PoseAt& truth) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < count; ++i) sum += truth(i).linear() * estimate(i).linear().transpose();
  return fit_rotation(sum).rotation;
}

}  // namespace

Alignment align(const std::vector<Pose>& estimate, const std::vector<Pose>& truth) {
  return align(
      std::min(estimate.size(), truth.size()),
      [&estimate](std::size_t i) -> const Pose& { return estimate[i]; },
      [&truth](std::size_t i) -> const Pose& { return truth[i]; });
}

Alignment align(std::size_t count, const PoseAt& estimate, const PoseAt& truth) {
  Alignment result;
  result.degenerate = count < 3;
  if (count == 0) return result;

  const Eigen::Matrix3Xd from = positions(count, estimate), to = positions(count, truth);
  const Eigen::Vector3d from_mean = from.rowwise().mean(), to_mean = to.rowwise().mean();
  const Eigen::Matrix3d covariance = (to.colwise() - to_mean) * (from.colwise() - from_mean).transpose();
  const RotationFit fit = fit_rotation(covariance);
  const Eigen::Vector3d& spread = fit.singular_values;
  if (count >= 3 && spread[1] > kLineRatio * spread[0]) {
    result.truth_from_estimate.linear() = fit.rotation;
    result.truth_from_estimate.translation() = to_mean - fit.rotation * from_mean;
    return result;
  }

  result.degenerate = true;
  Eigen::Matrix3d rotation = mean_rotation(count, estimate, truth);
  if (spread[0] > 0) {
    // Positions on a line: the rotation nearest the orientations' that lays line on line.
    const Eigen::Vector3d line_from = rotation * fit.from_axes.col(0), line_to = fit.to_axes.col(0);
    rotation = Eigen::Quaterniond::FromTwoVectors(line_from, line_to).toRotationMatrix() * rotation;
  }
  result.truth_from_estimate.linear() = rotation;
  result.truth_from_estimate.translation() = to_mean - rotation * from_mean;
  return result;
}

}  // namespace stillpoint
