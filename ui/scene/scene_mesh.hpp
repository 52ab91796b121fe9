#pragma once

#include <array>
#include <vector>

#include "ui/scene/scene_data.hpp"
#include "ui/scene/scene_view.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {

// The scene as what the graphics card takes: line segments, points and quads. No GL in here.

/// An end of a line segment, or a point. Laid out as the shaders read it.
struct SceneVertex {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< m, world
  std::array<std::uint8_t, 4> rgba{};
};
static_assert(sizeof(SceneVertex) == 16);

/// Pairs of vertices: from, to.
using Segments = std::vector<SceneVertex>;

[[nodiscard]] SceneVertex make_vertex(const Eigen::Vector3f& position, Rgb colour, float alpha = 1.0F);

/// The segments of a path; none from or to a position that is not finite.
[[nodiscard]] Segments path_segments(const ScenePath& path, ThemeName theme);

/// A path with fewer positions, none of those left out farther than `tolerance_m` from the one kept before
/// it. Ends and gaps stay.
[[nodiscard]] std::vector<Eigen::Vector3f> simplified(const std::vector<Eigen::Vector3f>& positions,
                                                      double tolerance_m);

/// How much of a path in `box` cannot be seen: half a pixel at its nearest, m, rounded down to a power of two
/// so that it seldom changes while the view moves; 0 when the path comes near to the eye.
[[nodiscard]] double unseen_detail(const SceneView& view, const Viewport& viewport, const SceneBounds& box);

/// Error lines, coloured by value over `scale_m`.
[[nodiscard]] Segments error_segments(const std::vector<SceneError>& errors, float scale_m);

/// The eight edges of a camera frustum and the mark on its upper side.
void append_frustum(Segments& segments, const Pose& world_from_camera, const FrustumShape& shape,
                    float depth_m, Rgb colour, float alpha = 1.0F);

/// The image corners of a frustum, world: upper left, upper right, lower left, lower right.
[[nodiscard]] std::array<Eigen::Vector3f, 4> frustum_image_corners(const Pose& world_from_camera,
                                                                   const FrustumShape& shape, float depth_m);

/// Metres between grid lines for a view: 1, 2 or 5 times a power of ten, about a fifteenth of what is seen.
[[nodiscard]] double grid_spacing(const SceneView& view);

/// A grid about the target's foot point that fades towards its edge; every fifth line is stronger.
[[nodiscard]] Segments grid_segments(const SceneView& view, const Eigen::Vector3d& up, double ground_m,
                                     const Theme& theme);

/// The world's axes at its origin: x red, y green, z blue, `length_m` long.
[[nodiscard]] Segments axes_segments(double length_m);

/// The colours of the x, y and z axis.
[[nodiscard]] std::array<Rgb, 3> axis_colours();

}  // namespace stillpoint
