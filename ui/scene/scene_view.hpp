#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>

#include "core/geometry/se3.hpp"
#include "ui/scene/scene_data.hpp"

namespace stillpoint {

// From where the 3-D scene is looked at: plain data and its arithmetic, without GL or ImGui.
//
// View coordinates: x right, y up, z towards the viewer. Viewport pixels: origin top left, x right, y down.

/// The rectangle drawn into, px.
struct Viewport {
  double width = 1.0, height = 1.0;
};

// GCC takes a scoped enumerator for one that shadows the global kNone of the map.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
/// How the view moves with the current camera.
enum class Follow {
  kNone,
  kPosition,  ///< keeps its place beside the camera
  kPose,      ///< and turns with it
};
#pragma GCC diagnostic pop

struct SceneView {
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< m, world: what orbiting turns about
  Eigen::Quaterniond world_from_view = Eigen::Quaterniond::Identity();
  double distance = 3.0;       ///< m, from the eye to the target
  double fov_y = 0.785398163;  ///< rad, from the lower to the upper edge
  Follow follow = Follow::kNone;
  std::optional<Pose> followed;  ///< the pose last followed
};

enum class ViewPreset {
  kOblique,  ///< from above at a slant
  kTop,      ///< a plan
  kFront,    ///< level, along the world's second horizontal axis
  kSide,     ///< level, along its first
  kCamera,   ///< through the current camera
};

[[nodiscard]] Eigen::Vector3d eye(const SceneView& view);
[[nodiscard]] Eigen::Matrix4d view_from_world(const SceneView& view);

/// Perspective with near and far planes in proportion to the distance.
[[nodiscard]] Eigen::Matrix4d clip_from_view(const SceneView& view, const Viewport& viewport);

/// Where a world point appears: x and y in px, z its depth in m; nothing for a point not in front of the eye.
[[nodiscard]] std::optional<Eigen::Vector3d> project(const SceneView& view, const Viewport& viewport,
                                                     const Eigen::Vector3d& world);

/// The world point under a pixel, in the plane through the target that faces the viewer.
[[nodiscard]] Eigen::Vector3d point_at_target(const SceneView& view, const Viewport& viewport,
                                              const Eigen::Vector2d& pixel);

/// Turns about the target: `delta_px` to the right about `up`, down about the view's own x axis, half a turn
/// across the viewport. Never past the poles.
void orbit(SceneView& view, const Viewport& viewport, const Eigen::Vector2d& delta_px,
           const Eigen::Vector3d& up);

/// Shifts so that what lies at the target's depth follows the mouse.
void pan(SceneView& view, const Viewport& viewport, const Eigen::Vector2d& delta_px);

/// Comes nearer (factor < 1) or goes farther, keeping the point at target depth under `cursor` where it is.
void zoom(SceneView& view, const Viewport& viewport, const Eigen::Vector2d& cursor, double factor);

/// Turns to a preset about the same target; kCamera also takes the eye to `camera` and, given none, does
/// nothing.
void look_from(SceneView& view, ViewPreset preset, const Eigen::Vector3d& up,
               const std::optional<Pose>& camera = {});

/// Moves target and distance so that the whole box is seen, direction kept, with a margin of a tenth.
void fit(SceneView& view, const Viewport& viewport, const SceneBounds& box);

/// Moves with the current camera as `view.follow` says; to be called with each frame's pose.
void follow(SceneView& view, const Pose& world_from_camera);

/// A position found under the mouse.
struct Picked {
  std::size_t index = 0;
  double distance_px = 0.0;  ///< from the cursor
};

/// The position that appears nearest to the cursor, at most `radius_px` away; of two at the same pixel the
/// one nearer to the eye.
[[nodiscard]] std::optional<Picked> pick(const SceneView& view, const Viewport& viewport,
                                         std::span<const Eigen::Vector3f> positions,
                                         const Eigen::Vector2d& cursor, double radius_px);

}  // namespace stillpoint
