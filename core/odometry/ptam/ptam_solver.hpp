#pragma once

#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/odometry/ptam/ptam_config.hpp"

namespace stillpoint {

/// Tukey's bound, squared: (4.6851 · 1.4826 · (1 + 5/(2n - 6)))² times the median of the squared errors.
/// @param squared of n errors, more than 3; reordered
[[nodiscard]] double tukey_bound_squared(std::vector<double>& squared);

/// Tukey's weight of a squared error: (1 - e²/bound²)², 0 beyond the bound.
[[nodiscard]] double tukey_weight(double squared, double bound_squared);

/// A found point, for the pose.
struct PtamSight {
  Eigen::Vector3d world = Eigen::Vector3d::Zero();
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< px, rectified, as at the middle row's time
  int level = 0;                                    ///< its error counts for 1 / 2^level
  double static_weight = 1;                         ///< by the motion method
  double weight = 0.0;                              ///< Tukey's, as the pose ended
  double squared_px = 0.0;                          ///< of its error at the level, as the pose ended
};

struct PtamPose {
  Pose camera_from_world = Pose::Identity();
  double bound_px = 0.0;  ///< Tukey's, at the level, of the last step
  int iterations = 0;
};

/// The pose by reprojection error, iterated and reweighed; each step is held by a prior.
/// @param late_bound_squared Tukey's bound from the seventh step on
[[nodiscard]] PtamPose solve_ptam_pose(std::vector<PtamSight>& sights, const Pose& start,
                                       const Camera& camera, double late_bound_squared,
                                       const PtamConfig& config);

/// A local bundle adjustment, as plain data.
struct PtamBundle {
  struct View {
    int keyframe = -1;
    Pose camera_from_world = Pose::Identity();
    bool fixed = false;
  };
  struct Point {
    int id = -1;
    Eigen::Vector3d world = Eigen::Vector3d::Zero();
  };
  struct Measurement {
    int view = 0, point = 0;  ///< indices
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    double depth = 0.0;  ///< m, sensed; 0 = none
    int level = 0;
    double static_weight = 1.0;
    bool outlier = false;  ///< as it ended
  };
  std::vector<View> views;
  std::vector<Point> points;
  std::vector<Measurement> measurements;
  int iterations = 0;
  double rms_before_px = 0.0, rms_after_px = 0.0;  ///< of all before, of the inliers after
};

/// Levenberg-Marquardt over free views and all points, with Tukey's weights; points by Schur complement.
void solve_ptam_bundle(PtamBundle& bundle, const Camera& camera, const PtamConfig& config);

}  // namespace stillpoint
