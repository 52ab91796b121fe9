#include <fmt/format.h>

#include "core/error.hpp"
#include "core/sequence/folder_camera.hpp"
#include "core/sequence/stereo/stereo_recording.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr const char *kLeftImages = "image_left", *kRightImages = "image_right", *kPoses = "pose_left.txt";

/// The camera that all its sequences were rendered by, as the data set's page has it.
Camera tartanair_camera() {
  Camera camera;
  camera.name = "tartanair";
  camera.width = 640, camera.height = 480;  // px
  camera.fx = camera.fy = 320.0;            // px
  camera.cx = 320.0, camera.cy = 240.0;     // px
  camera.baseline_m = 0.25;                 // m
  return camera;
}

/// Its poses are of axes forward, right and down; a camera's are right, down and forward.
Pose body_from_optical() {
  Pose pose = Pose::Identity();
  pose.linear() << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return pose;
}

}  // namespace

std::optional<StereoRecording> read_tartanair(const FileStore& folder, const OpenOptions& options) {
  if (!folder.is_folder(kLeftImages) || !folder.is_folder(kRightImages) || !folder.is_file(kPoses))
    return std::nullopt;
  StereoRecording recording;
  recording.lists.stereo = true;
  recording.lists.colours = images_of(folder, kLeftImages);
  recording.lists.depths = images_of(folder, kRightImages);
  for (const ImageList* list : {&recording.lists.colours, &*recording.lists.depths})
    if (list->entries.empty()) throw InputError(fmt::format("{}: holds no images", list->path));
  if (options.camera)
    recording.camera = *options.camera;
  else if (auto camera = camera_in_folder(folder))
    recording.camera = *camera;
  else
    recording.camera = tartanair_camera();
  recording.truth = kPoses;
  recording.is_pose_a_row = true;
  recording.body_from_camera = body_from_optical();
  // Row i is image i by its number, as frame numbers are read.
  const std::size_t rows = text_lines(folder.read_text(kPoses)).size();
  for (std::size_t i = 0; i < rows; ++i)
    recording.row_stamps.push_back(static_cast<double>(i) / options.frame_rate);
  return recording;
}

}  // namespace stillpoint
