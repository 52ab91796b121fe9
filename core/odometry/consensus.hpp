#pragma once

#include <cstdint>
#include <vector>

#include "core/odometry/pose_solver.hpp"

namespace stillpoint {

/// The pose most of the *image* agrees on.
struct Consensus {
  Pose camera_from_world = Pose::Identity();
  std::vector<std::uint8_t> inlier;  ///< one an observation
  int inliers = 0;
  double cost = 0.0;  ///< truncated squares, weighted by place; 0 to 1, less is better
};

/// Finds the pose that explains the scene tightly, among the guesses given and poses from samples of three
/// points with depth (RANSAC with truncated squares, Torr & Zisserman 2000). Observations of one part of the
/// image share their vote, so that a thing rich in texture weighs no more than its area; and the bound is
/// tight, for a dynamic object that goes with the camera looks, to a loose one, like a scene with another
/// motion.
/// @param seed makes the samples; same seed, same result
[[nodiscard]] Consensus consensus_pose(const Camera& camera, const std::vector<PoseObservation>& observations,
                                       const std::vector<Pose>& guesses, int samples, std::uint32_t seed);

}  // namespace stillpoint
