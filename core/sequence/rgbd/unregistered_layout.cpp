// The TUM layout with depth images of a depth camera of its own, as RealSense and Azure Kinect give them
// before they are aligned: camera.toml has the table [depth_camera].
#include <fmt/format.h>

#include "core/out_folder.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"
#include "core/sequence/write_sequence.hpp"

namespace stillpoint {
namespace {

RgbdNames unregistered_names(int, double seconds) {
  return {fmt::format("rgb/{:.6f}.png", seconds), fmt::format("depth/{:.6f}.png", seconds), seconds};
}

void write_unregistered(const WrittenRgbd& written) {
  Camera camera = registered_camera(written.source);
  camera.depth_scale = kMillimetreScale;
  camera.depth_camera = std::make_shared<const DepthCamera>(miniature_depth_camera());
  write_text_file(written.folder / "camera.toml", camera_text(camera));
  write_tum_texts(written, unregistered_names, "rgb.txt", "depth.txt");
  if (!written.source.ground_truth().empty())
    write_tum_trajectory((written.folder / "groundtruth.txt").string(), written.source.ground_truth());
}

}  // namespace

const RgbdLayout kUnregisteredLayout = {"unregistered",
                                        nullptr,
                                        {unregistered_names, kMillimetreScale, 0, true, write_unregistered,
                                         "rgb/*.png depth/*.png rgb.txt depth.txt"}};

}  // namespace stillpoint
