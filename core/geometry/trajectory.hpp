#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/se3.hpp"

namespace stillpoint {

/// A pose and when it was: seconds since any epoch.
struct StampedPose {
  double timestamp = 0.0;  ///< s
  Pose world_from_camera = Pose::Identity();
};

/// Poses by strictly increasing time.
using Trajectory = std::vector<StampedPose>;

/// Reads a TUM trajectory: `timestamp tx ty tz qx qy qz qw`, `#` starts a comment.
///
/// Lines out of order are sorted and, of equal stamps, the first is kept; quaternions off unit length by
/// less than 1 % are normalised. `warnings`, when given, receives a sentence for each such mending.
/// @throws InputError with file and line for an unreadable file, fewer or more than 8 numbers, NaN or
///         infinity, or a quaternion that is zero or far from unit length; and for a file without poses.
[[nodiscard]] Trajectory read_tum_trajectory(const std::string& path,
                                             std::vector<std::string>* warnings = nullptr);

/// Writes a TUM trajectory, exactly 8 columns a line.
/// @throws InputError when the file cannot be written.
void write_tum_trajectory(const std::string& path, const Trajectory& trajectory);

/// The index of the pose nearest in time and strictly closer than `tolerance` seconds, or nothing.
[[nodiscard]] std::optional<std::size_t> nearest_pose(const Trajectory& trajectory, double timestamp,
                                                      double tolerance);

/// The pose at a time between two stamps at most `max_gap` seconds apart: linear in translation, spherical in
/// rotation. Nothing outside the trajectory or in a larger gap.
[[nodiscard]] std::optional<Pose> interpolate(const Trajectory& trajectory, double timestamp, double max_gap);

}  // namespace stillpoint
