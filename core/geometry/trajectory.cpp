#include "core/geometry/trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/trajectory_file.hpp"
#include "core/out_folder.hpp"

namespace stillpoint {

Trajectory read_tum_trajectory(const std::string& path, std::vector<std::string>* warnings) {
  TrajectoryFile file = read_trajectory_file(path);
  if (warnings != nullptr) warnings->insert(warnings->end(), file.warnings.begin(), file.warnings.end());
  return std::move(file.poses);
}

std::string tum_text(const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d t = pose.world_from_camera.translation();
    const Eigen::Quaterniond q(pose.world_from_camera.linear());
    text += fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", pose.timestamp, t.x(),
                        t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

void write_tum_trajectory(const std::string& path, const Trajectory& trajectory) {
  write_text_file(path, tum_text(trajectory));
}

std::optional<std::size_t> nearest_pose(const Trajectory& trajectory, double timestamp, double tolerance) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), timestamp,
                                      [](const StampedPose& pose, double t) { return pose.timestamp < t; });
  auto nearest = after;
  if (after == trajectory.end() ||
      (after != trajectory.begin() && timestamp - (after - 1)->timestamp <= after->timestamp - timestamp)) {
    if (after == trajectory.begin()) return std::nullopt;
    nearest = after - 1;
  }
  if (!(std::abs(nearest->timestamp - timestamp) < tolerance)) return std::nullopt;
  return static_cast<std::size_t>(nearest - trajectory.begin());
}

std::optional<Pose> interpolate(const Trajectory& trajectory, double timestamp, double max_gap) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), timestamp,
                                      [](const StampedPose& pose, double t) { return pose.timestamp < t; });
  if (after == trajectory.end()) return std::nullopt;
  if (after->timestamp == timestamp) return after->world_from_camera;
  if (after == trajectory.begin()) return std::nullopt;
  const StampedPose& a = *(after - 1);
  const StampedPose& b = *after;
  const double gap = b.timestamp - a.timestamp;
  if (gap > max_gap) return std::nullopt;
  const double share = (timestamp - a.timestamp) / gap;
  const Eigen::Quaterniond qa(a.world_from_camera.linear()), qb(b.world_from_camera.linear());
  Pose pose = Pose::Identity();
  pose.linear() = qa.slerp(share, qb).normalized().toRotationMatrix();
  pose.translation() =
      (1.0 - share) * a.world_from_camera.translation() + share * b.world_from_camera.translation();
  return pose;
}

}  // namespace stillpoint
