#include <fmt/format.h>

#include "core/error.hpp"
#include "core/sequence/folder_camera.hpp"
#include "core/sequence/stereo/stereo_recording.hpp"

namespace stillpoint {
namespace {

constexpr const char *kLeft = "left", *kRight = "right", *kTimes = "times.txt";

Camera camera_of(const FileStore& folder, const OpenOptions& options) {
  if (options.camera) return *options.camera;
  if (auto camera = camera_in_folder(folder)) return *camera;
  throw InputError(fmt::format(
      "{}: left/ and right/ need a camera.toml (fx, fy, cx, cy, width, height and baseline_m, the "
      "distance of the two cameras), or --camera FILE",
      folder.place()));
}

}  // namespace

std::optional<StereoRecording> read_left_right(const FileStore& folder, const OpenOptions& options) {
  if (!folder.is_folder(kLeft) && !folder.is_folder(kRight)) return std::nullopt;
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
  recording.lists.colours = list(kLeft, kRight);
  recording.lists.depths = list(kRight, kLeft);
  recording.camera = camera_of(folder, options);
  if (recording.camera.has_distortion())
    throw InputError(
        fmt::format("{}: camera {} has distortion, and left/ and right/ are read as rectified images; "
                    "the EuRoC layout has a calibration a camera",
                    folder.place(), recording.camera.name));
  if (folder.is_there(kTimes))
    stamp_by_times(folder.path_of(kTimes), read_times(folder, kTimes), recording.lists);
  return recording;
}

}  // namespace stillpoint
