// Folders of Open3D: color/ (or image/, rgb/) and depth/ (mm), the intrinsic JSON of its readers of Azure
// Kinect and RealSense, which align depth to colour, and a .log trajectory (Choi, Zhou & Koltun 2015): five
// lines a pose, three numbers of which the first is the image's place, and the 4x4 of camera to world.
// Redwood's scenes have the trajectory and no JSON: the camera is PrimeSense's default.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/out_folder.hpp"
#include "core/sequence/folder_camera.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr const char* kMatrix = "intrinsic_matrix";

/// The JSON of intrinsics that a folder holds, by what it says.
std::optional<std::string> intrinsic_json(const FileStore& folder) {
  for (const std::string& name : folder.entries("")) {
    if (!name.ends_with(".json") || !folder.is_file(name)) continue;
    const auto json = parse_json(folder.read_text(name), false);
    if (json.is_object() && json.contains(kMatrix)) return name;
  }
  return std::nullopt;
}

bool is_log_head(const std::string& line) {
  const auto columns = split_columns(line);
  return columns.size() == 3 && std::all_of(columns.begin(), columns.end(), [](std::string_view column) {
           return parse_number(column).has_value() && column.find('.') == std::string_view::npos;
         });
}

/// The trajectory: trajectory.log before another.
std::optional<std::string> trajectory_log(const FileStore& folder) {
  std::optional<std::string> found;
  for (const std::string& name : folder.entries("")) {
    if (!name.ends_with(".log") || !folder.is_file(name)) continue;
    const auto lines = text_lines(folder.read_text(name));
    if (lines.empty() || !is_log_head(lines.front().text)) continue;
    const bool is_trajectory = name.find("traj") != std::string::npos;
    if (!found || is_trajectory) found = name;
    if (is_trajectory) break;
  }
  return found;
}

Camera open3d_camera(const FileStore& folder, const std::string& name, std::vector<std::string>& warnings) {
  const std::string path = folder.path_of(name);
  try {
    const auto json = parse_json(folder.read_text(name));
    const auto m = json.at(kMatrix).get<std::vector<double>>();
    if (m.size() != 9)
      throw InputError(fmt::format("{}: {} has {} numbers, expected 9", path, kMatrix, m.size()));
    Camera camera;
    camera.name = "open3d";
    camera.width = pixels_of(json.at("width")), camera.height = pixels_of(json.at("height"));
    camera.fx = m[0], camera.fy = m[4], camera.cx = m[6], camera.cy = m[7];
    // Column by column; somebody's own may be row by row.
    if (m[6] == 0 && m[7] == 0 && (m[2] != 0 || m[5] != 0)) {
      camera.cx = m[2], camera.cy = m[5];
      warnings.push_back(
          fmt::format("{}: {} is written row by row, where Open3D's is column by column; it was "
                      "read so",
                      path, kMatrix));
    }
    camera.depth_scale = json.value("depth_scale", kMillimetreScale);
    check_camera(path, camera);
    return camera;
  } catch (const nlohmann::json::exception& error) {
    throw InputError(
        fmt::format("{}: is no intrinsic of Open3D, {{width, height, {}}}: {}", path, kMatrix, error.what()));
  }
}

/// The pose of a block of five lines; nothing where it has none.
std::optional<Pose> pose_of_block(std::span<const TextLine> block) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Constant(std::nan(""));
  for (int row = 0; row < 4; ++row) {
    const auto columns = split_columns(block[static_cast<std::size_t>(row) + 1].text);
    for (int k = 0; k < 4 && columns.size() == 4; ++k)
      matrix(row, k) = parse_number(columns[static_cast<std::size_t>(k)]).value_or(std::nan(""));
  }
  return rigid_pose(matrix);
}

/// Poses at the stamps of the images whose places they name.
FolderTruth read_log(const FileStore& folder, const std::string& name, const ImageList& images) {
  constexpr std::size_t kLines = 5;  // lines a pose: three numbers of which it is, then a 4x4 matrix
  FolderTruth truth;
  truth.path = folder.path_of(name);
  const auto lines = text_lines(folder.read_text(name));
  std::string first_bad;
  double last = -1.0;
  for (std::size_t at = 0; at + kLines <= lines.size(); at += kLines) {
    if (!is_log_head(lines[at].text)) {
      truth.why_not = fmt::format("{}:{}: found {}, expected the three numbers that begin a pose", truth.path,
                                  lines[at].number, in_quotes(lines[at].text));
      truth.poses.clear();
      return truth;
    }
    const double place = parse_number(split_columns(lines[at].text).front()).value_or(-1.0);
    const auto pose = pose_of_block(std::span(lines).subspan(at, kLines));
    if (pose && place > last && place < static_cast<double>(images.entries.size())) {
      truth.poses.push_back({images.entries[static_cast<std::size_t>(place)].timestamp, *pose});
      last = place;
    } else if (first_bad.empty()) {
      first_bad =
          pose ? fmt::format("{}:{}: {} is the place of no image, or out of order; the pose was skipped",
                             truth.path, lines[at].number, place)
               : fmt::format("{}:{}: is no rigid motion, and costs its pose", truth.path, lines[at].number);
    }
  }
  if (!first_bad.empty()) truth.warnings.push_back(first_bad);
  if (lines.size() % kLines != 0)
    truth.warnings.push_back(
        fmt::format("{}:{}: the last pose was cut short and skipped", truth.path, lines.back().number));
  if (truth.poses.empty()) truth.why_not = fmt::format("{}: holds no pose of an image", truth.path);
  return truth;
}

/// The folder of colour images: Open3D's readers', or a name of Redwood's scenes.
std::optional<std::string> colour_folder(const FileStore& folder) {
  for (const char* name : {"color", "image", "rgb"})
    if (folder.is_folder(name)) return name;
  return std::nullopt;
}

std::optional<RgbdRecording> read_open3d(const FileStore& folder, const OpenOptions& options) {
  const auto colour = colour_folder(folder);
  if (!colour || has_image_lists(folder)) return std::nullopt;
  const auto json = intrinsic_json(folder), log = trajectory_log(folder);
  if (!json && !log) return std::nullopt;
  ImageList colours = images_of(folder, *colour);
  if (colours.entries.empty()) return std::nullopt;
  RgbdRecording recording;
  recording.lists = numbered_images(folder, std::move(colours), images_of(folder, "depth"));
  // Names are frame numbers, whatever their step, or microseconds.
  std::vector<double> numbers;
  for (const ListEntry& image : recording.lists->colours.entries) numbers.push_back(image.timestamp);
  if (unit_of(numbers) == StampUnit::milliseconds) recording.unit = StampUnit::frames;
  std::vector<std::string>& warnings = recording.lists->warnings;
  recording.camera = given_camera_or(folder, options, [&] {
    if (json) return open3d_camera(folder, *json, warnings);
    Camera camera = camera_by_name("ros_default");
    camera.depth_scale = kMillimetreScale;
    warnings.push_back(
        fmt::format("{}: has no intrinsic JSON; PrimeSense's default is taken, as for Redwood's scenes (525 "
                    "px, depth in mm)",
                    folder.place()));
    return camera;
  });
  recording.truth.emplace();
  if (log) recording.truth = read_log(folder, *log, recording.lists->colours);
  return recording;
}

/// Open3D's names are frame numbers of at least five digits.
RgbdNames azure_names(int index, double) {
  return {fmt::format("color/{:05}.jpg", index), fmt::format("depth/{:05}.png", index),
          static_cast<double>(index)};
}
RgbdNames redwood_names(int index, double) {
  return {fmt::format("image/{:06}.png", index + 1), fmt::format("depth/{:06}.png", index + 1),
          static_cast<double>(index + 1)};
}

void write_intrinsics(const WrittenRgbd& written, const char* name) {
  const Camera& c = written.source.camera();
  const nlohmann::json json = {
      {"width", c.width}, {"height", c.height}, {kMatrix, {c.fx, 0.0, 0.0, 0.0, c.fy, 0.0, c.cx, c.cy, 1.0}}};
  write_text_file(written.folder / name, json.dump(4) + "\n");
}

void write_azure(const WrittenRgbd& written) { write_intrinsics(written, "intrinsic.json"); }

void write_redwood(const WrittenRgbd& written) {
  write_intrinsics(written, "camera_primesense.json");
  std::string log;
  for (int i = 0; i < written.frames; ++i)
    if (const auto pose = written.pose(i))
      log += fmt::format("{0} {0} {1}\n{2}", i, i + 1, matrix_text(pose->matrix()));
  if (!log.empty()) write_text_file(written.folder / "trajectory.log", log);
}

}  // namespace

const RgbdLayout kOpen3dLayout = {
    "azure-kinect",
    read_open3d,
    {azure_names, kMillimetreScale, 0, false, write_azure, "color/*.jpg depth/*.png intrinsic.json"}};

const RgbdLayout kRedwoodLayout = {"redwood",
                                   nullptr,
                                   {redwood_names, kMillimetreScale, 0, false, write_redwood,
                                    "image/*.png depth/*.png trajectory.log camera_primesense.json"}};

}  // namespace stillpoint
