#include "ui/scene/scene_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "ui/theme/colormap.hpp"

namespace stillpoint {
namespace {

constexpr int kGridLinesEachSide = 20;  // lines: beyond, they have faded
constexpr int kGridPieces = 16;         // of a line, so that it can fade along its length
constexpr int kStrongEvery = 5;         // lines: the strong ones are counted by

/// One piece of a broken line. @param phase m along the pattern, carried from piece to piece
void append_dashes(Segments& segments, const Eigen::Vector3f& from, const Eigen::Vector3f& to, double dash_m,
                   double& phase, Rgb colour) {
  const double length = static_cast<double>((to - from).norm()), period = 2.0 * dash_m;
  // So many dashes in one piece would not be told apart; and a line need not end.
  if (!(length > 0.0) || length > 1e4 * period) return;
  for (double along = -phase; along < length; along += period) {
    const double begin = std::max(along, 0.0), end = std::min(along + dash_m, length);
    if (end <= begin) continue;
    segments.push_back(make_vertex(from + static_cast<float>(begin / length) * (to - from), colour));
    segments.push_back(make_vertex(from + static_cast<float>(end / length) * (to - from), colour));
  }
  phase = std::fmod(phase + length, period);
}

}  // namespace

Rgb path_colour(const ScenePath& path, ThemeName theme) {
  return path.colour.value_or(role_colour(path.role, theme));
}

SceneVertex make_vertex(const Eigen::Vector3f& position, Rgb colour, float alpha) {
  const auto opacity = static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(alpha, 0.0F, 1.0F)));
  return {position, {colour.r, colour.g, colour.b, opacity}};
}

Segments path_segments(const ScenePath& path, ThemeName theme) {
  const Rgb colour = path_colour(path, theme);
  Segments segments;
  segments.reserve(2 * path.positions.size());
  double phase = 0.0;
  for (std::size_t i = 1; i < path.positions.size(); ++i) {
    if (!path.positions[i - 1].allFinite() || !path.positions[i].allFinite()) continue;
    if (path.dash_m > 0.0) {
      append_dashes(segments, path.positions[i - 1], path.positions[i], path.dash_m, phase, colour);
      continue;
    }
    segments.push_back(make_vertex(path.positions[i - 1], colour));
    segments.push_back(make_vertex(path.positions[i], colour));
  }
  return segments;
}

std::vector<Eigen::Vector3f> simplified(const std::vector<Eigen::Vector3f>& positions, double tolerance_m) {
  std::vector<Eigen::Vector3f> kept;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const bool gap = !positions[i].allFinite();
    const bool at_end = i == 0 || i + 1 == positions.size() || gap || !positions[i - 1].allFinite() ||
                        !positions[i + 1].allFinite();
    if (at_end || static_cast<double>((positions[i] - kept.back()).norm()) > tolerance_m)
      kept.push_back(positions[i]);
  }
  return kept;
}

double unseen_detail(const SceneView& view, const Viewport& viewport, const SceneBounds& box) {
  const Eigen::Vector3d forward = view.world_from_view * -Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d half = 0.5 * (box.high - box.low);
  const double nearest = forward.dot(0.5 * (box.low + box.high) - eye(view)) - half.dot(forward.cwiseAbs());
  if (!(nearest > 0.1 * view.distance)) return 0.0;
  const double half_pixel = nearest * std::tan(0.5 * view.fov_y) / viewport.height;
  return std::exp2(std::floor(std::log2(half_pixel)));
}

Segments error_segments(const std::vector<SceneError>& errors, float scale_m) {
  Segments segments;
  segments.reserve(2 * errors.size());
  for (const SceneError& error : errors) {
    if (!error.from.allFinite() || !error.to.allFinite()) continue;
    const Rgb colour = map_colour(Colormap::kInferno, 0.25F + 0.75F * error.value_m / scale_m);
    segments.push_back(make_vertex(error.from, colour));
    segments.push_back(make_vertex(error.to, colour));
  }
  return segments;
}

std::array<Eigen::Vector3f, 4> frustum_image_corners(const Pose& world_from_camera, const FrustumShape& shape,
                                                     float depth_m) {
  std::array<Eigen::Vector3f, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = (i % 2 == 0 ? -1.0 : 1.0) * shape.half_width;
    const double y = (i < 2 ? -1.0 : 1.0) * shape.half_height;
    corners[i] = (world_from_camera * (Eigen::Vector3d(x, y, 1.0) * depth_m)).cast<float>();
  }
  return corners;
}

void append_frustum(Segments& segments, const Pose& world_from_camera, const FrustumShape& shape,
                    float depth_m, Rgb colour, float alpha) {
  const auto line = [&](const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
    segments.push_back(make_vertex(from, colour, alpha));
    segments.push_back(make_vertex(to, colour, alpha));
  };
  const Eigen::Vector3f apex = world_from_camera.translation().cast<float>();
  const auto [upper_left, upper_right, lower_left, lower_right] =
      frustum_image_corners(world_from_camera, shape, depth_m);
  for (const Eigen::Vector3f& corner : {upper_left, upper_right, lower_left, lower_right}) line(apex, corner);
  line(upper_left, upper_right);
  line(lower_left, lower_right);
  line(upper_left, lower_left);
  line(upper_right, lower_right);
  // A small roof tells which side is up.
  const double roof = -1.35 * shape.half_height;
  const Eigen::Vector3f top = (world_from_camera * (Eigen::Vector3d(0.0, roof, 1.0) * depth_m)).cast<float>();
  line(0.75F * upper_left + 0.25F * upper_right, top);
  line(0.25F * upper_left + 0.75F * upper_right, top);
}

double grid_spacing(const SceneView& view) {
  const double wanted = 2.0 * view.distance * std::tan(0.5 * view.fov_y) / 15.0;
  const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
  const double leading = wanted / decade;
  return decade * (leading < 1.5 ? 1.0 : leading < 3.5 ? 2.0 : leading < 7.5 ? 5.0 : 10.0);
}

Segments grid_segments(const SceneView& view, const Eigen::Vector3d& up, double ground_m,
                       const Theme& theme) {
  const double spacing = grid_spacing(view);
  const Eigen::Vector3d hint =
      std::abs(up.x()) < 0.9 ? Eigen::Vector3d::UnitX().eval() : Eigen::Vector3d::UnitY().eval();
  const Eigen::Vector3d first = (hint - hint.dot(up) * up).normalized();
  const Eigen::Vector3d second = up.cross(first);
  // Lines lie at whole multiples of the spacing, so that the grid is static while the view moves over it.
  const long centre_first = std::lround(view.target.dot(first) / spacing);
  const long centre_second = std::lround(view.target.dot(second) / spacing);
  const Eigen::Vector3d foot = view.target + (ground_m - view.target.dot(up)) * up;
  const double radius = spacing * kGridLinesEachSide;
  const Rgb colour = mix(theme.grid, theme.text_dim, 0.15F);

  Segments segments;
  const auto vertex = [&](const Eigen::Vector3d& position, float strength) {
    const double fade = std::max(0.0, 1.0 - (position - foot).norm() / radius);
    return make_vertex(position.cast<float>(), colour, strength * static_cast<float>(std::sqrt(fade)));
  };
  const auto line = [&](const Eigen::Vector3d& along, const Eigen::Vector3d& middle, bool strong) {
    const float strength = strong ? 1.0F : 0.5F;
    for (int piece = 0; piece < kGridPieces; ++piece) {
      const double from = 2.0 * radius * piece / kGridPieces - radius;
      const double to = 2.0 * radius * (piece + 1) / kGridPieces - radius;
      segments.push_back(vertex(middle + from * along, strength));
      segments.push_back(vertex(middle + to * along, strength));
    }
  };
  for (long i = -kGridLinesEachSide; i <= kGridLinesEachSide; ++i) {
    const long on_first = centre_first + i, on_second = centre_second + i;
    const Eigen::Vector3d height = ground_m * up;
    line(second,
         height +
             spacing * (static_cast<double>(on_first) * first + static_cast<double>(centre_second) * second),
         on_first % kStrongEvery == 0);
    line(first,
         height +
             spacing * (static_cast<double>(centre_first) * first + static_cast<double>(on_second) * second),
         on_second % kStrongEvery == 0);
  }
  return segments;
}

std::array<Rgb, 3> axis_colours() {
  return {Rgb{0xE0, 0x4F, 0x5F}, Rgb{0x4C, 0xB0, 0x5A}, Rgb{0x4D, 0x8D, 0xF0}};
}

Segments axes_segments(double length_m) {
  Segments segments;
  for (int axis = 0; axis < 3; ++axis) {
    const Rgb colour = axis_colours()[static_cast<std::size_t>(axis)];
    segments.push_back(make_vertex(Eigen::Vector3f::Zero(), colour));
    segments.push_back(make_vertex(static_cast<float>(length_m) * Eigen::Vector3f::Unit(axis), colour));
  }
  return segments;
}

}  // namespace stillpoint
