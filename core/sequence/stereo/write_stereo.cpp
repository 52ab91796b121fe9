#include "core/sequence/stereo/write_stereo.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/out_folder.hpp"
#include "core/sequence/association.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char *kCam0 = "mav0/cam0", *kCam1 = "mav0/cam1", *kTruth = "mav0/state_groundtruth_estimate0";

long long nanoseconds(double seconds) { return std::llround(seconds * 1e6) * 1000; }  // stamps are whole µs

/// Where EuRoC's left camera sits on its body: anywhere but at its centre, so that who reads the truth has to
/// mind it. A quarter turn has no rounding.
Pose body_from_left() {
  Pose pose = Pose::Identity();
  pose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  pose.translation() << -0.02, -0.065, 0.01;
  return pose;
}

std::string sensor_yaml(const Camera& camera, const Pose& body_from_camera) {
  std::string rows;
  for (int i = 0; i < 16; ++i)
    rows += fmt::format("{}{}",
                        i == 0       ? ""
                        : i % 4 == 0 ? ",\n         "
                                     : ", ",
                        body_from_camera.matrix()(i / 4, i % 4));
  return fmt::format(
      "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [{}]\nresolution: [{}, {}]\n"
      "camera_model: pinhole\nintrinsics: [{}, {}, {}, {}]  # fu, fv, cu, cv\n"
      "distortion_model: radial-tangential\ndistortion_coefficients: [0.0, 0.0, 0.0, 0.0]\n",
      rows, camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy);
}

void write_euroc(const FrameSource& source, const fs::path& folder, int frames) {
  const Camera& camera = source.camera();
  Pose right = body_from_left();
  right.translate(Eigen::Vector3d(camera.baseline_m, 0, 0));
  std::string list = "#timestamp [ns],filename\n";
  for (int i = 0; i < frames; ++i) list += fmt::format("{0},{0}.png\n", nanoseconds(source.timestamp(i)));
  for (const auto& [name, body_from_camera] : {std::pair(kCam0, body_from_left()), std::pair(kCam1, right)}) {
    write_text_file(folder / name / "data.csv", list);
    write_text_file(folder / name / "sensor.yaml", sensor_yaml(camera, body_from_camera));
  }
  if (source.ground_truth().empty()) return;
  std::string truth =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z []\n";
  for (const StampedPose& stamped : source.ground_truth()) {
    const Pose body = stamped.world_from_camera * body_from_left().inverse();
    const Eigen::Vector3d p = body.translation();
    const Eigen::Quaterniond q(body.linear());
    truth += fmt::format("{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n",
                         nanoseconds(stamped.timestamp), p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
  }
  fs::create_directories(folder / kTruth);
  write_text_file(folder / kTruth / "data.csv", truth);
}

void write_kitti(const FrameSource& source, const fs::path& folder, int frames) {
  const Camera& c = source.camera();
  std::string calibration, times, poses;
  for (int camera = 0; camera < 4; ++camera)
    calibration += fmt::format("P{}: {:.12e} 0 {:.12e} {:.12e} 0 {:.12e} {:.12e} 0 0 0 1 0\n", camera, c.fx,
                               c.cx, camera % 2 == 1 ? -c.fx * c.baseline_m : 0.0, c.fy, c.cy);
  bool all_known = frames > 0;
  for (int i = 0; i < frames; ++i) {
    times += fmt::format("{:.6f}\n", source.timestamp(i));
    const auto pose = interpolate(source.ground_truth(), source.timestamp(i), kTruthMaxGap);
    all_known = all_known && pose.has_value();
    for (int at = 0; pose && at < 12; ++at)
      poses += fmt::format("{:.9e}{}", pose->matrix()(at / 4, at % 4), at == 11 ? "\n" : " ");
  }
  write_text_file(folder / "calib.txt", calibration);
  write_text_file(folder / "times.txt", times);
  if (all_known) write_text_file(folder / "poses.txt", poses);
}

}  // namespace

StereoNames stereo_names(const FrameSource& source, int index, SequenceLayout layout) {
  if (layout == SequenceLayout::kitti) {
    const std::string name = fmt::format("{:06}.png", index);
    return {fs::path("image_2") / name, fs::path("image_3") / name};
  }
  if (layout == SequenceLayout::euroc) {
    const std::string name = fmt::format("{}.png", nanoseconds(source.timestamp(index)));
    return {fs::path(kCam0) / "data" / name, fs::path(kCam1) / "data" / name};
  }
  const std::string name = fmt::format("{:.6f}.png", source.timestamp(index));
  return {fs::path("left") / name, fs::path("right") / name};
}

const std::vector<std::string>& stereo_image_folders() {
  static const std::vector<std::string> folders = {"left",    "right",          "image_2",
                                                   "image_3", "mav0/cam0/data", "mav0/cam1/data"};
  return folders;
}

const std::vector<std::string>& stereo_text_files() {
  static const std::vector<std::string> files = {"calib.txt",
                                                 "times.txt",
                                                 "poses.txt",
                                                 "mav0/cam0/data.csv",
                                                 "mav0/cam1/data.csv",
                                                 "mav0/cam0/sensor.yaml",
                                                 "mav0/cam1/sensor.yaml",
                                                 "mav0/state_groundtruth_estimate0/data.csv"};
  return files;
}

void write_stereo_texts(const FrameSource& source, const fs::path& folder, int frames,
                        SequenceLayout layout) {
  if (layout == SequenceLayout::euroc) write_euroc(source, folder, frames);
  if (layout == SequenceLayout::kitti) write_kitti(source, folder, frames);
}

}  // namespace stillpoint
