#include "core/run/estimate_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/sequence/archive/archive_store.hpp"
#include "core/sequence/file_store.hpp"

namespace stillpoint {
namespace {

/// What programs of the field call their trajectory, best first.
constexpr const char* kTrajectoryNames[] = {"trajectory.txt",
                                            "trajectory.csv",
                                            "CameraTrajectory.txt",
                                            "FrameTrajectory_TUM_Format.txt",
                                            "traj.txt",
                                            "poses.txt",
                                            "estimate.txt",
                                            "stamped_traj_estimate.txt",
                                            "KeyFrameTrajectory.txt"};

/// The estimate among the trajectories of evo's results, each NAME.tum or NAME.kitti.
std::string estimate_in(const FileStore& results) {
  std::vector<std::string> trajectories;
  for (const std::string& name : results.entries(""))
    if (name.ends_with(".tum") || name.ends_with(".kitti")) trajectories.push_back(name);
  if (results.is_file("info.json")) {
    const auto info = parse_json(results.read_text("info.json"), false);
    const bool is_named = info.is_object() && info.contains("est_name") && info["est_name"].is_string();
    const std::string estimate = is_named ? info["est_name"].get<std::string>() : "";
    const std::string name = std::filesystem::path(estimate).filename().string();
    for (const std::string& trajectory : trajectories)
      if (!name.empty() && trajectory.starts_with(name)) return trajectory;
  }
  if (trajectories.size() == 1) return trajectories.front();
  throw InputError(fmt::format(
      "{}: holds {} trajectories and does not say which is the estimate; expected evo's results, saved with "
      "their trajectories",
      results.place(), trajectories.size()));
}

}  // namespace

std::string trajectory_in(const std::filesystem::path& folder) {
  std::error_code none;
  for (const char* name : kTrajectoryNames)
    if (std::filesystem::is_regular_file(folder / name, none)) return folder / name;
  throw InputError(
      fmt::format("{}: holds no trajectory (trajectory.txt, CameraTrajectory.txt, …)", folder.string()));
}

TrajectoryFile read_estimate_file(const std::string& path, std::optional<QuaternionOrder> order) {
  std::error_code none;
  if (std::filesystem::is_directory(path, none)) return read_trajectory_file(trajectory_in(path), order);
  if (!std::filesystem::is_regular_file(path, none) || !is_packed(path))
    return read_trajectory_file(path, order);
  const std::unique_ptr<FileStore> results = open_archive(unpack(path, {}).path, path);
  const std::string name = estimate_in(*results);
  return read_trajectory_text(results->path_of(name), results->read_text(name), order);
}

}  // namespace stillpoint
