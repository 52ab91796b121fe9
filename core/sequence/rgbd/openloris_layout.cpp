// OpenLORIS-Scene: color.txt and aligned_depth.txt (mm) in the manner of TUM's lists, sensors.yaml with the
// D435i's colour camera, whose intrinsics stand as fx, cx, fy, cy, and groundtruth.txt of the robot's
// base_link, on which trans_matrix.yaml says where the camera sits.
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <vector>

#include "core/error.hpp"
#include "core/out_folder.hpp"
#include "core/sequence/folder_camera.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"
#include "core/sequence/write_sequence.hpp"

namespace stillpoint {
namespace {

constexpr const char *kSensorsFile = "sensors.yaml", *kPlacesFile = "trans_matrix.yaml",
                     *kColourFrame = "d400_color_optical_frame", *kBase = "base_link";

/// OpenCV's YAML, whose first line is none of YAML 1.2.
YAML::Node load_opencv_yaml(const FileStore& folder, const char* name) {
  std::string text = folder.read_text(name);
  if (text.starts_with("%YAML")) text.erase(0, text.find('\n'));
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw InputError(
        fmt::format("{}:{}: is no YAML: {}", folder.path_of(name), error.mark.line + 1, error.msg));
  }
}

/// What YAML's accessors throw, as one sentence.
template <typename Act>
auto sentence_for(const FileStore& folder, const char* name, Act&& act) {
  try {
    return act();
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}:{}: {}", folder.path_of(name), error.mark.line + 1, error.msg));
  }
}

std::vector<double> matrix_data(const YAML::Node& node) {
  return node && node.IsMap() && node["data"] ? node["data"].as<std::vector<double>>()
                                              : std::vector<double>();
}

Camera openloris_camera(const FileStore& folder) {
  const std::string path = folder.path_of(kSensorsFile);
  const YAML::Node root = load_opencv_yaml(folder, kSensorsFile);
  return sentence_for(folder, kSensorsFile, [&] {
    const YAML::Node sensor = root.IsMap() ? root[kColourFrame] : YAML::Node();
    const auto intrinsics =
        sensor && sensor.IsMap() ? matrix_data(sensor["intrinsics"]) : std::vector<double>();
    if (intrinsics.size() < 4 || !sensor["width"] || !sensor["height"])
      throw InputError(fmt::format("{}: {} has no width, height and intrinsics", path, kColourFrame));
    Camera camera;
    camera.name = "openloris";
    camera.width = sensor["width"].as<int>(), camera.height = sensor["height"].as<int>();
    camera.fx = intrinsics[0], camera.cx = intrinsics[1], camera.fy = intrinsics[2],
    camera.cy = intrinsics[3];
    camera.depth_scale = kMillimetreScale;
    if (auto d = matrix_data(sensor["distortion_coefficients"]); !d.empty()) {
      d.resize(5, 0.0);
      camera.k1 = d[0], camera.k2 = d[1], camera.p1 = d[2], camera.p2 = d[3], camera.k3 = d[4];
    }
    check_camera(path, camera);
    return camera;
  });
}

/// Where the camera sits on the robot.
Pose base_from_camera(const FileStore& folder) {
  const YAML::Node root = load_opencv_yaml(folder, kPlacesFile);
  return sentence_for(folder, kPlacesFile, [&] {
    const YAML::Node list = root.IsMap() ? root["trans_matrix"] : YAML::Node();
    if (list && list.IsSequence())
      for (const YAML::Node& place : list) {
        if (!place.IsMap() || !place["parent_frame"] || !place["child_frame"]) continue;
        if (place["parent_frame"].as<std::string>() != kBase ||
            place["child_frame"].as<std::string>() != kColourFrame)
          continue;
        const auto numbers = matrix_data(place["matrix"]);
        Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
        for (std::size_t i = 0; i < numbers.size() && i < 16; ++i)
          matrix(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = numbers[i];
        if (const auto pose = rigid_pose(matrix)) return *pose;
        throw InputError(fmt::format("{}: the matrix of {} is no rigid motion", folder.path_of(kPlacesFile),
                                     kColourFrame));
      }
    throw InputError(fmt::format("{}: does not say where {} sits on {}", folder.path_of(kPlacesFile),
                                 kColourFrame, kBase));
  });
}

std::optional<RgbdRecording> read_openloris(const FileStore& folder, const OpenOptions& options) {
  if (!folder.is_file("color.txt") || !folder.is_file("aligned_depth.txt") || !folder.is_file(kSensorsFile))
    return std::nullopt;
  RgbdRecording recording;
  recording.camera = given_camera_or(folder, options, [&] { return openloris_camera(folder); });
  if (!folder.is_file("groundtruth.txt")) return recording;
  try {
    if (!folder.is_file(kPlacesFile))
      throw InputError(
          fmt::format("{}: is missing; groundtruth.txt is of {}, and it says where the camera sits",
                      folder.path_of(kPlacesFile), kBase));
    recording.body_from_camera = base_from_camera(folder);
  } catch (const InputError& error) {
    recording.no_truth = error.what();
  }
  return recording;
}

RgbdNames openloris_names(int, double seconds) {
  return {fmt::format("color/{:.6f}.png", seconds), fmt::format("aligned_depth/{:.6f}.png", seconds),
          seconds};
}

/// Where the miniature's camera sits: high on the robot, looking ahead (z forward to x forward), to the left.
Pose miniature_base_from_camera() {
  Pose pose = Pose::Identity();
  pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  pose.translation() << 0.21, 0.04, 1.2;
  return pose;
}

std::string opencv_matrix(const char* indent, int rows, int columns, const std::vector<double>& numbers) {
  std::string data;
  for (const double number : numbers) data += fmt::format("{}{:.16e}", data.empty() ? "" : ", ", number);
  return fmt::format("!!opencv-matrix\n{0}   rows: {1}\n{0}   cols: {2}\n{0}   dt: d\n{0}   data: [ {3} ]\n",
                     indent, rows, columns, data);
}

void write_openloris(const WrittenRgbd& written) {
  const Camera& c = written.source.camera();
  write_text_file(
      written.folder / kSensorsFile,
      fmt::format("%YAML:1.0\n---\n{0}:\n   sensor_type: camera\n   sensor_name: {0}\n   fps: 30\n"
                  "   width: {1}\n   height: {2}\n   model: pinhole\n   intrinsics: {3}"
                  "   distortion_model: \"radial-tangential\"\n   distortion_coefficients: {4}",
                  kColourFrame, c.width, c.height, opencv_matrix("   ", 1, 4, {c.fx, c.cx, c.fy, c.cy}),
                  opencv_matrix("   ", 1, 5, {c.k1, c.k2, c.p1, c.p2, c.k3})));
  const Pose place = miniature_base_from_camera();
  std::vector<double> numbers;
  for (int i = 0; i < 16; ++i) numbers.push_back(place.matrix()(i / 4, i % 4));
  write_text_file(
      written.folder / kPlacesFile,
      fmt::format("%YAML:1.0\n---\ntrans_matrix:\n   -\n      parent_frame: {}\n      child_frame: {}\n"
                  "      matrix: {}",
                  kBase, kColourFrame, opencv_matrix("      ", 4, 4, numbers)));
  write_tum_texts(written, openloris_names, "color.txt", "aligned_depth.txt");
  Trajectory bases = written.source.ground_truth();
  for (StampedPose& pose : bases) pose.world_from_camera = pose.world_from_camera * place.inverse();
  if (!bases.empty()) write_tum_trajectory((written.folder / "groundtruth.txt").string(), bases);
}

}  // namespace

const RgbdLayout kOpenLorisLayout = {
    "openloris",
    read_openloris,
    {openloris_names, kMillimetreScale, 0, false, write_openloris,
     "color/*.png aligned_depth/*.png color.txt aligned_depth.txt sensors.yaml trans_matrix.yaml"}};

}  // namespace stillpoint
