#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/se3.hpp"
#include "ui/theme/palette.hpp"

namespace stillpoint {

/// A trajectory as a line through the world. A position that is not finite breaks it.
struct ScenePath {
  std::string name{};  ///< in the legend
  Role role = Role::kEstimate;
  std::vector<Eigen::Vector3f> positions{};  ///< m, world
  float width_px = 2.5F;
  bool pickable = false;         ///< its positions answer to the mouse
  std::optional<Rgb> colour{};   ///< instead of its role's
  double dash_m = 0.0;           ///< length of dashes and of the gaps between; 0 = unbroken
  bool named_elsewhere = false;  ///< as below the picture
};

/// The colour a path is drawn in.
[[nodiscard]] Rgb path_colour(const ScenePath& path, ThemeName theme);

/// The error between two associated poses, drawn as a line between them.
struct SceneError {
  Eigen::Vector3f from, to;  ///< m, world
  float value_m = 0.0F;      ///< what colours it
};

struct ScenePoint {
  Eigen::Vector3f position;  ///< m, world
  bool removed = false;      ///< taken for moving
};

/// What the camera frusta look like.
struct FrustumShape {
  float half_width = 0.61F,
        half_height = 0.457F;      ///< of the image at depth 1; width / 2 / fx, height / 2 / fy
  float keyframe_depth_m = 0.08F;  ///< from the apex to the image, keyframes
  float current_depth_m = 0.35F;   ///< … and the current camera
};

/// All the trajectory view draws, wherever it comes from. World coordinates, metres.
struct SceneData {
  std::vector<ScenePath> paths;
  std::vector<SceneError> errors;
  float error_scale_m = 0.1F;   ///< error at the upper end of the colour scale
  std::vector<Pose> keyframes;  ///< world_from_camera each
  std::optional<Pose> current;  ///< world_from_camera of the frame shown
  cv::Mat current_image;        ///< shown in its frustum; 8UC1 or 8UC3 BGR, may be empty
  std::vector<ScenePoint> points;
  FrustumShape frustum;
  Eigen::Vector3d up{0.0, 0.0, 1.0};  ///< unit; the grid is perpendicular to it
  double ground_m = 0.0;              ///< the grid's height along `up`
  bool show_legend = true;  ///< over the picture; where it would cover too much of it, it stands elsewhere
  bool show_grid = true;
  bool show_axes = true;

  /// To be raised when paths, errors, keyframes or points change: what lies on the graphics card is kept
  /// until then.
  std::uint64_t revision = 0;
  /// The same for current_image.
  std::uint64_t image_revision = 0;
};

/// A box along the world's axes.
struct SceneBounds {
  Eigen::Vector3d low, high;  ///< m
};

/// The box around paths, keyframes and the current camera, or around the points where there are none of
/// these; a metre about the origin for an empty scene. Points alone would let a few far ones decide.
[[nodiscard]] SceneBounds bounds(const SceneData& scene);

}  // namespace stillpoint
