#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/se3.hpp"

namespace stillpoint {

/// What somebody's file may mean by a pose, other than camera to world, z forward, y down.
enum class PoseConvention {
  as_written,  ///< camera to world, as it stands
  inverse,     ///< world to camera
  w_first,     ///< the quaternion's real part stands first, and was read as the last
  mirrored_x,  ///< both frames mirrored: F T F, F = diag(-1, 1, 1)
  mirrored_y,  ///< F = diag(1, -1, 1): ICL-NUIM, whose images have y down and whose poses have it up
  mirrored_z,  ///< F = diag(1, 1, -1)
  opengl,  ///< the camera's own axes with y up and z backward: T diag(1, -1, -1), as NeRF and Blender write
  bonn,    ///< the pose of Bonn's marker body: T_ROS⁻¹ G T_ROS T_m
};

/// All but as_written, in the order above.
[[nodiscard]] const std::vector<PoseConvention>& other_conventions();

/// As `--truth` takes it: "as-written", "inverse", "w-first", "mirrored-x", …, "bonn".
[[nodiscard]] std::string_view to_string(PoseConvention convention);

/// What it means, for messages: "the poses are world to camera", …
[[nodiscard]] std::string_view meaning_of(PoseConvention convention);

/// @return nothing for a name that is none
[[nodiscard]] std::optional<PoseConvention> convention_by_name(std::string_view name);

/// The camera's pose in the world that a pose written in that convention means.
[[nodiscard]] Pose camera_pose(const Pose& written, PoseConvention convention);

/// The pose that a file of that convention has for a camera's pose: the inverse of camera_pose, for all but
/// w_first.
[[nodiscard]] Pose written_pose(const Pose& world_from_camera, PoseConvention convention);

}  // namespace stillpoint
