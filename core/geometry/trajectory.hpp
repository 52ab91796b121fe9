#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/se3.hpp"

namespace stillpoint {

/// Images and poses belong together when they are strictly closer in time than this; the TUM benchmark's
/// figure.
inline constexpr double kAssociationTolerance = 0.02;  // s

/// A pose and when it was: seconds since any epoch.
struct StampedPose {
  double timestamp = 0.0;  ///< s
  Pose world_from_camera = Pose::Identity();
};

/// Poses by strictly increasing time.
using Trajectory = std::vector<StampedPose>;

/// The poses of read_trajectory_file, with stamps as they are written. `warnings`, when given, receives a
/// sentence for each mending.
/// @throws InputError as that does.
[[nodiscard]] Trajectory read_tum_trajectory(const std::string& path,
                                             std::vector<std::string>* warnings = nullptr);

/// A trajectory in the TUM format, exactly 8 columns a line.
[[nodiscard]] std::string tum_text(const Trajectory& trajectory);

/// Writes it to a file.
/// @throws InputError when the file cannot be written.
void write_tum_trajectory(const std::string& path, const Trajectory& trajectory);

/// The index of the pose nearest in time and strictly closer than `tolerance` seconds, or nothing.
[[nodiscard]] std::optional<std::size_t> nearest_pose(const Trajectory& trajectory, double timestamp,
                                                      double tolerance);

/// The pose at a time between two stamps at most `max_gap` seconds apart: linear in translation, spherical in
/// rotation. Nothing outside the trajectory or in a larger gap.
[[nodiscard]] std::optional<Pose> interpolate(const Trajectory& trajectory, double timestamp, double max_gap);

}  // namespace stillpoint
