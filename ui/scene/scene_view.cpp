#include "ui/scene/scene_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace stillpoint {
namespace {

// Times the distance to what is looked at: from within reach to the horizon.
constexpr double kNearShare = 0.02, kFarShare = 200.0;
// To what is looked at: within, single precision holds.
constexpr double kLeastDistance = 1e-3, kMostDistance = 1e5;  // m
constexpr double kPoleMargin = 0.01;  // rad off straight up or down, where sideways has no meaning
constexpr double kFitMargin = 1.1;    // times what just fits, so that nothing touches the rim

/// Two horizontal axes that with `up` make a right-handed frame; the world's own x and y when up is z.
std::array<Eigen::Vector3d, 2> horizontal_axes(const Eigen::Vector3d& up) {
  const Eigen::Vector3d hint =
      std::abs(up.x()) < 0.9 ? Eigen::Vector3d::UnitX().eval() : Eigen::Vector3d::UnitY().eval();
  const Eigen::Vector3d first = (hint - hint.dot(up) * up).normalized();
  return {first, up.cross(first)};
}

/// The view rotation that looks along `forward` with `up` upwards on the screen.
Eigen::Quaterniond looking(const Eigen::Vector3d& forward, const Eigen::Vector3d& up) {
  Eigen::Matrix3d world_from_view;
  const Eigen::Vector3d right = forward.cross(up).normalized();
  world_from_view << right, right.cross(forward), -forward;
  return Eigen::Quaterniond(world_from_view);
}

double tan_half_fov(const SceneView& view) { return std::tan(0.5 * view.fov_y); }

/// Metres a pixel at the target's depth.
double metres_per_pixel(const SceneView& view, const Viewport& viewport) {
  return 2.0 * view.distance * tan_half_fov(view) / viewport.height;
}

}  // namespace

Eigen::Vector3d eye(const SceneView& view) {
  return view.target + view.distance * (view.world_from_view * Eigen::Vector3d::UnitZ());
}

Eigen::Matrix4d view_from_world(const SceneView& view) {
  Eigen::Isometry3d world_from_view = Eigen::Isometry3d::Identity();
  world_from_view.linear() = view.world_from_view.toRotationMatrix();
  world_from_view.translation() = eye(view);
  return world_from_view.inverse().matrix();
}

Eigen::Matrix4d clip_from_view(const SceneView& view, const Viewport& viewport) {
  const double near = kNearShare * view.distance, far = kFarShare * view.distance;
  const double scale_y = 1.0 / tan_half_fov(view);
  Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
  clip(0, 0) = scale_y * viewport.height / viewport.width;
  clip(1, 1) = scale_y;
  clip(2, 2) = (far + near) / (near - far);
  clip(2, 3) = 2.0 * far * near / (near - far);
  clip(3, 2) = -1.0;
  return clip;
}

std::optional<Eigen::Vector3d> project(const SceneView& view, const Viewport& viewport,
                                       const Eigen::Vector3d& world) {
  const Eigen::Vector3d in_view = view.world_from_view.conjugate() * (world - eye(view));
  const double depth = -in_view.z();
  if (!(depth > 0.0)) return std::nullopt;
  const double px_per_unit = 0.5 * viewport.height / tan_half_fov(view);
  return Eigen::Vector3d{0.5 * viewport.width + px_per_unit * in_view.x() / depth,
                         0.5 * viewport.height - px_per_unit * in_view.y() / depth, depth};
}

Eigen::Vector3d point_at_target(const SceneView& view, const Viewport& viewport,
                                const Eigen::Vector2d& pixel) {
  const double scale = metres_per_pixel(view, viewport);
  const Eigen::Vector3d offset{(pixel.x() - 0.5 * viewport.width) * scale,
                               (0.5 * viewport.height - pixel.y()) * scale, 0.0};
  return view.target + view.world_from_view * offset;
}

void orbit(SceneView& view, const Viewport& viewport, const Eigen::Vector2d& delta_px,
           const Eigen::Vector3d& up) {
  const double rad_per_px = std::numbers::pi / std::min(viewport.width, viewport.height);
  // The angle between the line of sight and the pole bounds how far the tilt may go.
  const double from_pole =
      std::acos(std::clamp((view.world_from_view * Eigen::Vector3d::UnitZ()).dot(up), -1.0, 1.0));
  const double least = std::min(from_pole, kPoleMargin),
               most = std::max(from_pole, std::numbers::pi - kPoleMargin);
  const double tilt = from_pole - std::clamp(from_pole - delta_px.y() * rad_per_px, least, most);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(-delta_px.x() * rad_per_px, up));
  const Eigen::Quaterniond nod(Eigen::AngleAxisd(-tilt, Eigen::Vector3d::UnitX()));
  view.world_from_view = (turn * view.world_from_view * nod).normalized();
}

void pan(SceneView& view, const Viewport& viewport, const Eigen::Vector2d& delta_px) {
  const double scale = metres_per_pixel(view, viewport);
  view.target += view.world_from_view * Eigen::Vector3d(-delta_px.x() * scale, delta_px.y() * scale, 0.0);
}

void zoom(SceneView& view, const Viewport& viewport, const Eigen::Vector2d& cursor, double factor) {
  const Eigen::Vector3d fixed = point_at_target(view, viewport, cursor);
  const double distance = std::clamp(view.distance * factor, kLeastDistance, kMostDistance);
  view.target = fixed + (view.target - fixed) * (distance / view.distance);
  view.distance = distance;
}

void look_from(SceneView& view, ViewPreset preset, const Eigen::Vector3d& up,
               const std::optional<Pose>& camera) {
  const auto [first, second] = horizontal_axes(up);
  switch (preset) {
    case ViewPreset::kOblique:
      view.world_from_view = looking((0.55 * first + second - 0.75 * up).normalized(), up);
      return;
    case ViewPreset::kTop:
      view.world_from_view = looking(-up, second);
      return;
    case ViewPreset::kFront:
      view.world_from_view = looking(second, up);
      return;
    case ViewPreset::kSide:
      view.world_from_view = looking(-first, up);
      return;
    case ViewPreset::kCamera: {
      if (!camera) return;
      // A camera has y down and z forward, a view y up and z backward.
      Eigen::Matrix3d camera_from_view = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
      view.world_from_view = Eigen::Quaterniond(camera->linear() * camera_from_view).normalized();
      view.target = *camera * Eigen::Vector3d(0.0, 0.0, view.distance);
      return;
    }
  }
}

void fit(SceneView& view, const Viewport& viewport, const SceneBounds& box) {
  const Eigen::Matrix3d view_from_world = view.world_from_view.toRotationMatrix().transpose();
  const double tan_y = tan_half_fov(view), tan_x = tan_y * viewport.width / viewport.height;
  view.target = 0.5 * (box.low + box.high);
  double distance = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d world{(corner & 1) != 0 ? box.high.x() : box.low.x(),
                                (corner & 2) != 0 ? box.high.y() : box.low.y(),
                                (corner & 4) != 0 ? box.high.z() : box.low.z()};
    const Eigen::Vector3d relative = view_from_world * (world - view.target);
    distance = std::max({distance, kFitMargin * std::abs(relative.x()) / tan_x + relative.z(),
                         kFitMargin * std::abs(relative.y()) / tan_y + relative.z()});
  }
  view.distance = std::clamp(distance, 0.1, kMostDistance);
}

void follow(SceneView& view, const Pose& world_from_camera) {
  if (view.follow == Follow::kNone) {
    view.followed.reset();
    return;
  }
  if (view.followed) {
    if (view.follow == Follow::kPosition) {
      view.target += world_from_camera.translation() - view.followed->translation();
    } else {
      const Pose now_from_before = world_from_camera * view.followed->inverse();
      view.target = now_from_before * view.target;
      view.world_from_view =
          (Eigen::Quaterniond(now_from_before.linear()) * view.world_from_view).normalized();
    }
  }
  view.followed = world_from_camera;
}

std::optional<Picked> pick(const SceneView& view, const Viewport& viewport,
                           std::span<const Eigen::Vector3f> positions, const Eigen::Vector2d& cursor,
                           double radius_px) {
  constexpr double kSamePixel = 0.5;  // px: as near as that, what is nearer to the eye is picked
  std::optional<Picked> best;
  double best_depth = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto seen = project(view, viewport, positions[i].cast<double>());
    if (!seen) continue;
    const double distance = (seen->head<2>() - cursor).norm();
    if (!(distance <= radius_px)) continue;
    const bool nearer_px = !best || distance < best->distance_px - kSamePixel;
    const bool nearer_eye = best && distance < best->distance_px + kSamePixel && seen->z() < best_depth;
    if (!nearer_px && !nearer_eye) continue;
    best = Picked{i, distance};
    best_depth = seen->z();
  }
  return best;
}

}  // namespace stillpoint
