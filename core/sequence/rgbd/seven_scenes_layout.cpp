// 7-Scenes (Shotton et al. 2013): frame-000000.color.png, .depth.png (mm, 65535 = no measurement) and
// .pose.txt (4x4, camera to world) side by side. It has no calibration: 585 px and the image's middle are
// what the data set's page gives for the depth camera; the colour camera was not calibrated, nor depth
// registered to it.
#include <fmt/format.h>

#include "core/out_folder.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"
#include "core/sequence/write_sequence.hpp"

namespace stillpoint {
namespace {

constexpr const char *kColourEnd = ".color.png", *kDepthEnd = ".depth.png", *kPoseEnd = ".pose.txt";

ImageList images_ending(const FileStore& folder, const char* end) {
  return images_of(folder, "", [end](const std::string& name) {
    return name.starts_with("frame-") && name.ends_with(end);
  });
}

std::optional<RgbdRecording> read_seven_scenes(const FileStore& folder, const OpenOptions& options) {
  ImageList colours = images_ending(folder, kColourEnd);
  if (colours.entries.empty()) return std::nullopt;
  RgbdRecording recording;
  recording.unit = StampUnit::frames;
  recording.lists = numbered_images(folder, std::move(colours), images_ending(folder, kDepthEnd));
  recording.camera = given_camera_or(folder, options, [&] {
    Camera camera;
    camera.name = "7-scenes";
    camera.fx = camera.fy = 585.0, camera.cx = 320.0, camera.cy = 240.0;
    camera.depth_scale = kMillimetreScale;
    recording.lists->warnings.push_back(
        fmt::format("{}: 7-Scenes has no calibration; its depth camera's default of 585 px is taken for "
                    "colour as well, and depth as if it were registered (camera.toml says otherwise)",
                    folder.place()));
    return camera;
  });
  recording.truth = read_pose_files(folder, recording.lists->colours, "", [](const ListEntry& image) {
    return image.file.substr(0, image.file.size() - std::string(kColourEnd).size()) + kPoseEnd;
  });
  return recording;
}

std::string stem(int index) { return fmt::format("frame-{:06}", index); }

void write_seven_scenes(const WrittenRgbd& written) {
  Camera camera = registered_camera(written.source);
  camera.depth_scale = kMillimetreScale;
  write_text_file(written.folder / "camera.toml", camera_text(camera));
  for (int i = 0; i < written.frames; ++i)
    if (const auto pose = written.pose(i))
      write_text_file(written.folder / (stem(i) + kPoseEnd), matrix_text(pose->matrix()));
}

}  // namespace

const RgbdLayout kSevenScenesLayout = {
    "7-scenes",
    read_seven_scenes,
    {[](int index, double) {
       return RgbdNames{stem(index) + kColourEnd, stem(index) + kDepthEnd, static_cast<double>(index)};
     },
     kMillimetreScale, 65535, false, write_seven_scenes, "frame-*.png frame-*.txt"}};

}  // namespace stillpoint
