#pragma once

#include <Eigen/Core>

namespace stillpoint {

/// The rotation that turns vectors onto others with the least sum of squared distances, and what its
/// decomposition tells of how well they settle it. (Kabsch, A solution for the best rotation to relate two
/// sets of vectors, 1976; Umeyama 1991)
struct RotationFit {
  Eigen::Matrix3d rotation;  ///< proper: its determinant is 1
  Eigen::Vector3d
      singular_values;      ///< of the sum, falling; a second one near 0 leaves the turn about one axis open
  Eigen::Matrix3d to_axes;  ///< columns: principal axes of what is turned onto …
  Eigen::Matrix3d from_axes;  ///< … and of what is turned
};

/// Compiled once, for the decomposition takes four seconds to compile.
/// @param sum of to * from^T over all pairs: of vectors from their means, or of rotations
[[nodiscard]] RotationFit fit_rotation(const Eigen::Matrix3d& sum);

}  // namespace stillpoint
