#include "core/sequence/folder_truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/error.hpp"
#include "core/geometry/trajectory_file.hpp"
#include "core/sequence/association.hpp"

namespace stillpoint {
namespace {

constexpr const char* kIclEnding = ".gt.freiburg";
constexpr double kFewestShare = 0.5;  // of the frames; truth of fewer is told

/// The name of the file of ground truth.
std::optional<std::string> find_truth(const FileStore& folder) {
  for (const char* name : {"groundtruth.txt", "groundtruth.csv", "ground_truth.txt", "gt.txt"})
    if (folder.is_there(name)) return name;
  for (const std::string& name : folder.entries(""))
    if (name.ends_with(kIclEnding)) return name;
  return std::nullopt;
}

std::vector<double> stamps_of(const Trajectory& poses) {
  std::vector<double> stamps;
  for (const StampedPose& pose : poses) stamps.push_back(pose.timestamp);
  return stamps;
}

/// Why truth in seconds meets no frame.
std::string apart(const std::string& path, const Trajectory& poses, const std::vector<double>& frames) {
  const double first = poses.front().timestamp, last = poses.back().timestamp;
  const std::string start = fmt::format("{}: none of its {} poses is within {} s of a frame: ", path,
                                        poses.size(), kAssociationTolerance);
  if (first > frames.back())
    return start + fmt::format("it begins {:.3f} s after the last frame ({:.3f} s against {:.3f} s)",
                               first - frames.back(), first, frames.back());
  if (last < frames.front())
    return start + fmt::format("it ends {:.3f} s before the first frame ({:.3f} s against {:.3f} s)",
                               frames.front() - last, last, frames.front());
  return start + "it covers their time, but has no pose near enough to any";
}

}  // namespace

FolderTruth read_folder_truth(const FileStore& folder, const std::vector<double>& frame_stamps,
                              StampUnit unit, double frame_rate, PoseConvention convention) {
  FolderTruth truth;
  const auto name = find_truth(folder);
  if (!name) return truth;
  truth.path = folder.path_of(*name);
  TrajectoryFile file;
  try {
    file = read_trajectory_text(truth.path, folder.read_text(*name));
  } catch (const InputError& error) {
    truth.why_not = error.what();
    return truth;
  }
  FolderTruth settled =
      settle_truth(truth.path, std::move(file.poses), frame_stamps, unit, frame_rate, convention);
  settled.warnings.insert(settled.warnings.begin(), file.warnings.begin(), file.warnings.end());
  return settled;
}

FolderTruth settle_truth(const std::string& path, Trajectory poses, const std::vector<double>& frame_stamps,
                         StampUnit unit, double frame_rate, PoseConvention convention) {
  FolderTruth truth;
  truth.path = path;
  truth.poses = std::move(poses);
  const StampUnit own =
      unit_beside(stamps_of(truth.poses), frame_stamps, unit, frame_rate, kAssociationTolerance);
  for (StampedPose& pose : truth.poses) {
    pose.timestamp *= seconds_per(own, frame_rate);
    pose.world_from_camera = camera_pose(pose.world_from_camera, convention);
  }
  const int met = meetings(frame_stamps, stamps_of(truth.poses), kAssociationTolerance);
  if (met == 0) {
    truth.why_not = apart(path, truth.poses, frame_stamps);
    truth.poses.clear();
    return truth;
  }
  if (own != unit)
    truth.warnings.push_back(fmt::format("{}: the stamps are {}, where those of the frames are {}", path,
                                         to_string(own), to_string(unit)));
  if (met < kFewestShare * static_cast<double>(frame_stamps.size()))
    truth.warnings.push_back(fmt::format("{}: has poses for {} of the {} frames; errors are of these alone",
                                         path, met, frame_stamps.size()));
  if (path.ends_with(kIclEnding) && convention == PoseConvention::as_written)
    truth.warnings.push_back(
        fmt::format("{}: ICL-NUIM's poses as published are mirrored in y against its PNG images; if these "
                    "are (rotations off by "
                    "degrees), `--truth mirrored-y` reads them rightly",
                    path));
  return truth;
}

}  // namespace stillpoint
