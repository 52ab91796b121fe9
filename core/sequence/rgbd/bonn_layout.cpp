// Bonn RGB-D Dynamic: the TUM layout, whose truth is the pose of a marker body on the camera (`--truth
// bonn`).
#include <fmt/format.h>

#include "core/geometry/pose_convention.hpp"
#include "core/out_folder.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"
#include "core/sequence/write_sequence.hpp"

namespace stillpoint {
namespace {

RgbdNames bonn_names(int, double seconds) {
  return {fmt::format("rgb/{:.5f}.png", seconds), fmt::format("depth/{:.5f}.png", seconds), seconds};
}

void write_bonn(const WrittenRgbd& written) {
  Camera camera = registered_camera(written.source);
  camera.name = "bonn";
  write_text_file(written.folder / "camera.toml", camera_text(camera));
  write_tum_texts(written, bonn_names, "rgb.txt", "depth.txt");
  Trajectory bodies = written.source.ground_truth();
  for (StampedPose& pose : bodies)
    pose.world_from_camera = written_pose(pose.world_from_camera, PoseConvention::bonn);
  if (!bodies.empty()) write_tum_trajectory((written.folder / "groundtruth.txt").string(), bodies);
}

}  // namespace

const RgbdLayout kBonnLayout = {
    "bonn", nullptr, {bonn_names, 5000.0, 0, false, write_bonn, "rgb/*.png depth/*.png rgb.txt depth.txt"}};

}  // namespace stillpoint
