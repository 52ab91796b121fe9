#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "core/geometry/se3.hpp"

namespace stillpoint {

/// What an observation says of a point p in the camera: with A = ∂r/∂p and weights W, the two products of its
/// residuals r. Where it lies and how the camera is turned make equations of the pose and of the world's
/// point.
struct SightEquations {
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();  ///< AᵀWA
  Eigen::Vector3d g = Eigen::Vector3d::Zero();  ///< AᵀWr
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< m, camera coordinates
};

/// The normal equations of bundle adjustment: poses of six parameters (a left perturbation of
/// camera_from_world, translation first) and points of three, which see each other only through observations.
/// Solved by eliminating the points (Schur complement), which leaves a dense system of the poses; Triggs et
/// al., "Bundle adjustment: a modern synthesis" (2000), §6.1. Sums run in the order of the calls: the same
/// bytes for the same calls.
class SchurEquations {
 public:
  /// A fixed pose's observations inform the point alone.
  static constexpr int kFixed = -1;

  struct Step {
    std::vector<Vector6d> poses;
    std::vector<Eigen::Vector3d> points;  ///< m
    double cost_change = 0.0;             ///< of rᵀWr, as the equations foresee it; negative
  };

  /// Starts anew, all zero.
  void reset(int poses, int points);
  /// Adds an observation. Points come in order: none before one that had its turn.
  /// @param pose 0 to poses - 1, or kFixed @param rotation of camera_from_world
  void add(int pose, int point, const Eigen::Matrix3d& rotation, const SightEquations& sight);
  /// The step of Levenberg and Marquardt: each parameter's own entry in H grows by `damping` times itself. A
  /// pose or point that nothing was said of stays.
  /// @returns whether all of it is finite
  [[nodiscard]] bool solve(double damping, Step& step) const;

 private:
  using Cross = Eigen::Matrix<double, 6, 3>;
  struct PosePart {
    Matrix6d h = Matrix6d::Zero();
    Vector6d g = Vector6d::Zero();
  };
  struct PointPart {
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    std::size_t crosses = 0;  // how many of those below are this point's
  };

  std::vector<PosePart> poses_;
  std::vector<PointPart> points_;
  std::vector<std::pair<int, Cross>> crosses_;  // pose, and its block with the point; point by point
  int last_point_ = 0;                          // that an observation was given of
};

}  // namespace stillpoint
