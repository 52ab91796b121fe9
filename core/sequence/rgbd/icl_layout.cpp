// ICL-NUIM's PNG folders: rgb/0.png, depth/0.png (5000 a metre), associations.txt of frame numbers with depth
// first, and NAME.gt.freiburg, whose poses are mirrored in y: its ray tracer's camera has y up (fy = -480),
// and the PNG images have it down (`--truth mirrored-y`).
#include <fmt/format.h>

#include "core/geometry/pose_convention.hpp"
#include "core/out_folder.hpp"
#include "core/sequence/folder_camera.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"
#include "core/sequence/write_sequence.hpp"

namespace stillpoint {
namespace {

constexpr const char* kIclTruth = "livingRoom0n.gt.freiburg";

std::optional<RgbdRecording> read_icl(const FileStore& folder, const OpenOptions& options) {
  bool is_icl = false;
  for (const std::string& name : folder.entries("")) is_icl = is_icl || name.ends_with(".gt.freiburg");
  if (!is_icl) return std::nullopt;
  RgbdRecording recording;
  recording.camera = given_camera_or(folder, options, [&] {
    for (const std::string& name : folder.own_names())
      if (const auto known = camera_from_folder_name(name)) return *known;
    return camera_by_name("icl_nuim");
  });
  return recording;
}

RgbdNames icl_names(int index, double) {
  return {fmt::format("rgb/{}.png", index), fmt::format("depth/{}.png", index), static_cast<double>(index)};
}

void write_icl(const WrittenRgbd& written) {
  write_text_file(written.folder / "camera.toml", camera_text(registered_camera(written.source)));
  std::string pairs;
  Trajectory poses;
  for (int i = 0; i < written.frames; ++i) {
    pairs += fmt::format("{0} depth/{0}.png {0} rgb/{0}.png\n", i);
    if (const auto pose = written.pose(i))
      poses.push_back({static_cast<double>(i), written_pose(*pose, PoseConvention::mirrored_y)});
  }
  write_text_file(written.folder / "associations.txt", pairs);
  if (!poses.empty()) write_tum_trajectory((written.folder / kIclTruth).string(), poses);
}

}  // namespace

const RgbdLayout kIclLayout = {
    "icl",
    read_icl,
    {icl_names, 5000.0, 0, false, write_icl, "rgb/*.png depth/*.png livingRoom0n.gt.freiburg"}};

}  // namespace stillpoint
