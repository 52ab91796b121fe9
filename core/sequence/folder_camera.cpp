#include "core/sequence/folder_camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace stillpoint {
namespace {

// Of both sides, where a principal point is that of images of half or twice the size: a lens sits near the
// middle.
constexpr double kHalved = 0.3, kDoubled = 0.85;
constexpr double kSameSides =
    0.01;  // relative difference of the two scales: a rounded pixel, not another shape

}  // namespace

std::optional<Camera> camera_in_folder(const FileStore& folder) {
  for (const char* name : {"camera.toml", "camera.yaml", "camera.yml"})
    if (folder.is_there(name)) return read_camera_text(folder.path_of(name), folder.read_text(name));
  return std::nullopt;
}

void check_camera(const std::string& path, const Camera& c) {
  constexpr int kLeast = 32, kMost = 16384;  // px, as of camera.toml
  const auto is_size = [](int px) { return px >= kLeast && px <= kMost; };
  for (const double value : {c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3, c.depth_scale})
    if (!std::isfinite(value)) throw InputError(fmt::format("{}: holds a number that is not finite", path));
  if (c.fx <= 0 || c.fy <= 0 || c.depth_scale <= 0 || !is_size(c.width) || !is_size(c.height))
    throw InputError(fmt::format("{}: is no camera: fx {:g}, fy {:g}, {}x{} px, depth scale {:g}", path, c.fx,
                                 c.fy, c.width, c.height, c.depth_scale));
}

Camera camera_of_folder(const FileStore& folder, const std::optional<Camera>& given,
                        std::vector<std::string>& warnings) {
  if (given) return *given;
  if (auto camera = camera_in_folder(folder)) return *camera;
  for (const std::string& name : folder.own_names())
    if (const auto known = camera_from_folder_name(name)) return *known;
  Camera camera = camera_by_name("ros_default");
  warnings.push_back(
      fmt::format("{}: the name tells no camera; {} is assumed (--camera NAME|FILE says which)",
                  folder.place(), camera.name));
  return camera;
}

Camera camera_for_size(const Camera& camera, cv::Size size, const std::string& folder,
                       std::vector<std::string>& warnings) {
  // Of images of twice or half the size both coordinates are off by that; a crop may leave one of them
  // anywhere.
  const double right = camera.cx / camera.width, down = camera.cy / camera.height;
  if (std::max(right, down) < kHalved || std::min(right, down) > kDoubled)
    warnings.push_back(fmt::format(
        "{}: the principal point of camera {} is ({:.0f}, {:.0f}) of {}x{} px, far from the middle: are its "
        "intrinsics of images of another size?",
        folder, camera.name, camera.cx, camera.cy, camera.width, camera.height));
  if (size == cv::Size(camera.width, camera.height)) return camera;
  const double sx = static_cast<double>(size.width) / camera.width;
  const double sy = static_cast<double>(size.height) / camera.height;
  if (std::abs(sx / sy - 1.0) < kSameSides) {
    warnings.push_back(
        fmt::format("{}: images are {}x{} px; the intrinsics of camera {} ({}x{} px) were scaled to them",
                    folder, size.width, size.height, camera.name, camera.width, camera.height));
    return camera.scaled_to(size.width, size.height);
  }
  const double scale = std::max(sx, sy);
  const int width = static_cast<int>(std::lround(scale * camera.width));
  const int height = static_cast<int>(std::lround(scale * camera.height));
  Camera middle = camera.scaled_to(width, height);
  middle.cx -= 0.5 * (width - size.width), middle.cy -= 0.5 * (height - size.height);
  middle.width = size.width, middle.height = size.height;
  warnings.push_back(fmt::format(
      "{}: images are {}x{} px, whose sides do not fit the {}x{} px of camera {}; they were taken for the "
      "middle of its image "
      "(fx {:.1f}, fy {:.1f}, cx {:.1f}, cy {:.1f}); if they were made otherwise, --camera FILE says how",
      folder, size.width, size.height, camera.width, camera.height, camera.name, middle.fx, middle.fy,
      middle.cx, middle.cy));
  return middle;
}

}  // namespace stillpoint
