// Replica as NICE-SLAM rendered it: results/frame000000.jpg and depth000000.png, traj.txt (a row a frame: the
// 4x4 of camera to world, z forward), and cam_params.json, beside the sequence or in the folder of all
// sequences, with the depth images' units a metre as its scale.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/geometry/trajectory_file.hpp"
#include "core/json_text.hpp"
#include "core/out_folder.hpp"
#include "core/sequence/folder_camera.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"

namespace stillpoint {
namespace {

constexpr const char *kResults = "results", *kTrajectory = "traj.txt", *kParameters = "cam_params.json";
constexpr double kReplicaScale = 6553.5;  // raw values a metre: 16 bits are 10 m

Camera replica_camera(const FileStore& folder) {
  std::string name = kParameters;
  if (!folder.is_file(name)) name = std::string("../") + kParameters;
  const std::string path = folder.path_of(name);
  if (!folder.is_file(name))
    throw InputError(fmt::format(
        "{}: has no {}, neither here nor in the folder above; it says how Replica's camera sees (or --camera "
        "FILE does)",
        folder.place(), kParameters));
  try {
    const auto parameters = parse_json(folder.read_text(name)).at("camera");
    Camera camera;
    camera.name = "replica";
    camera.width = pixels_of(parameters.at("w")), camera.height = pixels_of(parameters.at("h"));
    camera.fx = parameters.at("fx"), camera.fy = parameters.at("fy");
    camera.cx = parameters.at("cx"), camera.cy = parameters.at("cy");
    camera.depth_scale = parameters.at("scale");
    check_camera(path, camera);
    return camera;
  } catch (const nlohmann::json::exception& error) {
    throw InputError(
        fmt::format("{}: is no camera of Replica, {{\"camera\": {{w, h, fx, fy, cx, cy, scale}}}}: {}", path,
                    error.what()));
  }
}

ImageList results_with(const FileStore& folder, const char* start) {
  return images_of(folder, kResults, [start](const std::string& name) { return name.starts_with(start); });
}

std::optional<RgbdRecording> read_replica(const FileStore& folder, const OpenOptions& options) {
  if (!folder.is_folder(kResults)) return std::nullopt;
  ImageList colours = results_with(folder, "frame");
  if (colours.entries.empty()) return std::nullopt;
  RgbdRecording recording;
  recording.unit = StampUnit::frames;
  recording.lists = numbered_images(folder, std::move(colours), results_with(folder, "depth"));
  recording.camera = given_camera_or(folder, options, [&] { return replica_camera(folder); });
  FolderTruth& truth = recording.truth.emplace();
  if (!folder.is_file(kTrajectory)) return recording;
  truth.path = folder.path_of(kTrajectory);
  try {
    TrajectoryFile file = read_trajectory_text(truth.path, folder.read_text(kTrajectory));
    truth.poses = std::move(file.poses);  // stamped by their rows, which are the frames' numbers
    truth.warnings = std::move(file.warnings);
  } catch (const InputError& error) {
    truth.why_not = error.what();
  }
  return recording;
}

void write_replica(const WrittenRgbd& written) {
  const Camera& c = written.source.camera();
  const nlohmann::json camera = {
      {"w", c.width}, {"h", c.height},         {"fx", c.fx}, {"fy", c.fy}, {"cx", c.cx},
      {"cy", c.cy},   {"scale", kReplicaScale}};
  write_text_file(written.folder / kParameters, nlohmann::json({{"camera", camera}}).dump(4) + "\n");
  std::string rows;
  for (int i = 0; i < written.frames; ++i) {
    const auto pose = written.pose(i);
    // A row is a frame's whether it is known or not.
    for (int at = 0; at < 16; ++at)
      rows += fmt::format("{:.12e}{}", pose ? pose->matrix()(at / 4, at % 4) : std::nan(""),
                          at == 15 ? "\n" : " ");
  }
  write_text_file(written.folder / kTrajectory, rows);
}

}  // namespace

const RgbdLayout kReplicaLayout = {"replica",
                                   read_replica,
                                   {[](int index, double) {
                                      return RgbdNames{fmt::format("results/frame{:06}.jpg", index),
                                                       fmt::format("results/depth{:06}.png", index),
                                                       static_cast<double>(index)};
                                    },
                                    kReplicaScale, 0, false, write_replica,
                                    "results/frame*.jpg results/depth*.png traj.txt cam_params.json"}};

}  // namespace stillpoint
