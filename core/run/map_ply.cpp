#include "core/run/map_ply.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/geometry/pixel_conventions.hpp"

namespace stillpoint {
namespace {

constexpr const char* kPlyHead =
    "ply\nformat ascii 1.0\ncomment world coordinates in metres: the first tracked frame's camera\n";
constexpr const char* kPlyPosition = "property float x\nproperty float y\nproperty float z\n";
constexpr const char* kPlyColour = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
constexpr const char* kKeyframeOrange = "230 159 0";

std::string ply_numbers(const Eigen::Vector3d& v, int digits) {
  return fmt::format("{:.{}f} {:.{}f} {:.{}f}", v.x(), digits, v.y(), digits, v.z(), digits);
}

/// As the trajectory view draws them: in proportion to the way, within what suits a room.
double frustum_depth_m(const std::vector<SavedKeyframe>& keyframes) {
  Eigen::Vector3d low = keyframes.front().pose.world_from_camera.translation(), high = low;
  for (const SavedKeyframe& keyframe : keyframes) {
    low = low.cwiseMin(keyframe.pose.world_from_camera.translation());
    high = high.cwiseMax(keyframe.pose.world_from_camera.translation());
  }
  return std::clamp(0.06 * (high - low).norm(), 0.015, 0.18);
}

}  // namespace

std::string map_ply(const std::vector<SavedPoint>& points, const std::vector<Eigen::Vector3f>& normals,
                    const std::vector<SavedKeyframe>& keyframes) {
  std::string text = fmt::format(
      "{}element vertex {}\n{}{}{}end_header\n", kPlyHead, points.size() + keyframes.size(), kPlyPosition,
      normals.empty() ? "" : "property float nx\nproperty float ny\nproperty float nz\n", kPlyColour);
  const auto vertex = [&](const Eigen::Vector3d& p, const Eigen::Vector3f& normal, std::string_view colour) {
    text += ply_numbers(p, 5) + " ";
    if (!normals.empty()) text += ply_numbers(normal.cast<double>(), 4) + " ";
    text += colour;
    text += '\n';
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Vec3b& c = points[i].colour;
    vertex(points[i].position, normals.empty() ? Eigen::Vector3f::Zero() : normals[i],
           fmt::format("{} {} {}", c[2], c[1], c[0]));
  }
  for (const SavedKeyframe& keyframe : keyframes)
    vertex(keyframe.pose.world_from_camera.translation(), Eigen::Vector3f::Zero(), kKeyframeOrange);
  return text;
}

std::string keyframes_ply(const std::vector<SavedKeyframe>& keyframes, const Camera& camera) {
  const std::size_t count = keyframes.size();
  std::string vertices, faces, edges;
  const double depth = count == 0 ? 0.0 : frustum_depth_m(keyframes);
  for (std::size_t i = 0; i < count; ++i) {
    const Pose& pose = keyframes[i].pose.world_from_camera;
    const auto vertex = [&](const Eigen::Vector3d& p) {
      vertices +=
          fmt::format("{} {} {}\n", ply_numbers(pose * p, 5), kKeyframeOrange, keyframes[i].frame_index);
    };
    vertex(Eigen::Vector3d::Zero());
    const double right = camera.width, bottom = camera.height;
    for (const RasterPoint& corner : {RasterPoint(0.0, 0.0), RasterPoint(right, 0.0),
                                      RasterPoint(right, bottom), RasterPoint(0.0, bottom)})
      vertex(camera.back_project(to_pixel(corner), depth));
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const std::size_t tip = 5 * i, here = tip + 1 + corner, next = tip + 1 + (corner + 1) % 4;
      faces += fmt::format("3 {} {} {}\n", tip, here, next);
      edges += fmt::format("{} {}\n{} {}\n", tip, here, here, next);
    }
  }
  return fmt::format(
             "{}element vertex {}\n{}{}property int frame\nelement face {}\nproperty list uchar int "
             "vertex_indices\nelement edge {}\nproperty int vertex1\nproperty int vertex2\nend_header\n",
             kPlyHead, 5 * count, kPlyPosition, kPlyColour, 4 * count, 8 * count) +
         vertices + faces + edges;
}

}  // namespace stillpoint
