#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/wide_lanes.hpp"

namespace stillpoint {

/// A map point and where the frame sees it.
struct PoseObservation {
  Eigen::Vector3d point_in_world;  ///< m
  Eigen::Vector2d pixel;           ///< px, undistorted
  double depth = 0.0;              ///< m, measured; 0 = none
  double sigma_px = 1.0;           ///< standard deviation of the pixel: the scale of the feature's octave
  double static_weight = 1.0;  ///< 0 to 1, of being static: weighs its squares, not its bound as an outlier
};

/// Depth enters beside pixels as what a stereo rig of this baseline (m) would measure in px: b fx / z. It is
/// the distance between the projector and the camera of a Kinect, whose depth errors grow the same way.
inline constexpr double kDepthBaseline = kKinectBaseline;

/// 95 % bounds of χ² with 2 (pixel) and 3 (pixel and depth) degrees of freedom: beyond them, an outlier.
inline constexpr double kChi2Pixel = 5.991, kChi2PixelDepth = 7.815;

/// What came of refining a pose.
struct PoseRefinement {
  Pose camera_from_world = Pose::Identity();
  std::vector<std::uint8_t> inlier;  ///< one an observation
  std::vector<float> residual_px;    ///< one an observation: distance in the image under the refined pose
  int inliers = 0;
  int iterations = 0;                       ///< Levenberg-Marquardt steps over all rounds
  double rms_before_px = 0.0;               ///< of the final inliers, under the initial pose
  double rms_px = 0.0;                      ///< … and under the refined one
  Matrix6d information = Matrix6d::Zero();  ///< JᵀWJ at the end, translation first
  double noise = 1.0;  ///< standard deviations by which the inliers miss, in the unit of their sigma_px

  /// Of a left perturbation of camera_from_world, by the inliers' own noise: m², rad², translation first;
  /// zero where they do not tell.
  [[nodiscard]] Matrix6d covariance() const;
};

/// eq. (5): minimises ½ Σ ‖u_i − (1/s) K exp(ξ^) P_i‖² over ξ ∈ se(3), robustly (Huber), from an initial
/// pose. In rounds, after each of which inliers are told from outliers anew. With tracking.depth_weight above
/// 0 a third residual compares depth. With fewer than 3 observations the pose is returned as it came, without
/// inliers.
/// @param start_gate where what is dynamic may have a large part in the observations, and the initial pose is
/// known not to follow it: those beyond this many times their χ² bound at the start take no part in the first
/// round, unless fewer than tracking.min_inliers are left; 0 = all do
/// @param wide for processors that have such lanes; the same to the last bit
[[nodiscard]] PoseRefinement refine_pose(const Camera& camera,
                                         const std::vector<PoseObservation>& observations,
                                         const Pose& initial_camera_from_world, const TrackingConfig& config,
                                         double start_gate = 0.0, bool wide = has_wide_lanes());

/// EPnP (Lepetit et al. 2009) inside RANSAC.
struct InitialPose {
  Pose camera_from_world = Pose::Identity();
  std::vector<int> inliers;  ///< indices of observations
};

/// A pose from 3-D to 2-D matches of which many may be wrong; nothing when fewer than
/// tracking.min_initial_matches agree. Deterministic.
[[nodiscard]] std::optional<InitialPose> initial_pose(const Camera& camera,
                                                      const std::vector<PoseObservation>& observations,
                                                      const TrackingConfig& config);

}  // namespace stillpoint
