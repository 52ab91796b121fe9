#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/error.hpp"
#include "core/sequence/folder_camera.hpp"
#include "core/sequence/stereo/stereo_recording.hpp"

namespace stillpoint {
namespace {

/// What the folders of a pair's images are called.
struct SideNames {
  const char *left, *right;
};
constexpr SideNames kSides[] = {{"left", "right"}, {"Left", "Right"}, {"image_left", "image_right"}};
constexpr const char* kTimes = "times.txt";

Camera camera_of(const FileStore& folder, const OpenOptions& options, const SideNames& sides) {
  if (options.camera) return *options.camera;
  if (auto camera = camera_in_folder(folder)) return *camera;
  throw InputError(
      fmt::format("{}: {}/ and {}/ need a camera.toml (fx, fy, cx, cy, width, height and baseline_m, the "
                  "distance of the two cameras), or --camera FILE",
                  folder.place(), sides.left, sides.right));
}

}  // namespace

std::optional<StereoRecording> read_left_right(const FileStore& folder, const OpenOptions& options) {
  const auto* sides = std::find_if(std::begin(kSides), std::end(kSides), [&folder](const SideNames& names) {
    return folder.is_folder(names.left) || folder.is_folder(names.right);
  });
  if (sides == std::end(kSides)) return std::nullopt;
  const auto list = [&](const char* name, const char* other) {
    ImageList images = images_of(folder, name);
    if (images.entries.empty())
      throw InputError(fmt::format("{}: {}; depth comes of two images a frame, and {} holds the other one",
                                   folder.path_of(name),
                                   folder.is_folder(name) ? "holds no images" : "is missing", other));
    return images;
  };
  StereoRecording recording;
  recording.lists.stereo = true;
  recording.lists.colours = list(sides->left, sides->right);
  recording.lists.depths = list(sides->right, sides->left);
  recording.camera = camera_of(folder, options, *sides);
  if (recording.camera.has_distortion())
    throw InputError(
        fmt::format("{}: camera {} has distortion, and {}/ and {}/ are read as rectified images; "
                    "the EuRoC layout has a calibration a camera",
                    folder.place(), recording.camera.name, sides->left, sides->right));
  if (folder.is_there(kTimes))
    stamp_by_times(folder.path_of(kTimes), read_times(folder, kTimes), recording.lists);
  return recording;
}

}  // namespace stillpoint
