#include "core/geometry/trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>

#include "core/error.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr double kLengthTolerance = 0.01;   // quaternions farther from unit length are refused
constexpr double kLengthRemarkable = 1e-3;  // four decimals, as the benchmark writes, stay below this
constexpr const char* kColumns = "timestamp tx ty tz qx qy qz qw";

/// Something mended on several lines, told in one sentence.
struct Mending {
  int count = 0, first_line = 0;
  void note(int line) {
    if (count++ == 0) first_line = line;
  }
  void tell(std::vector<std::string>* warnings, const std::string& path, const char* what) const {
    if (warnings != nullptr && count > 0)
      warnings->push_back(fmt::format("{}:{}: {} ({} in all)", path, first_line, what, count));
  }
};

struct ReadPose {
  StampedPose pose;
  int line = 0;
};

std::array<double, 8> read_numbers(const std::string& path, const TextLine& line) {
  const auto columns = split_columns(line.text);
  if (columns.size() != 8)
    throw InputError(fmt::format("{}:{}: found {} columns, expected the 8 numbers {}", path, line.number,
                                 columns.size(), kColumns));
  std::array<double, 8> numbers{};
  for (std::size_t i = 0; i < 8; ++i) {
    const auto number = parse_number(columns[i]);
    if (!number || !std::isfinite(*number))
      throw InputError(fmt::format("{}:{}: found {} in column {}, expected a finite number ({})", path,
                                   line.number, in_quotes(columns[i]), i + 1, kColumns));
    numbers[i] = *number;
  }
  return numbers;
}

}  // namespace

Trajectory read_tum_trajectory(const std::string& path, std::vector<std::string>* warnings) {
  std::vector<ReadPose> read;
  Mending unsorted, repeated, normalised_length;
  for (const TextLine& line : read_text_lines(path)) {
    const auto n = read_numbers(path, line);
    const Eigen::Quaterniond q(n[7], n[4], n[5], n[6]);
    const double length = q.norm();
    if (!(std::abs(length - 1.0) < kLengthTolerance))
      throw InputError(fmt::format("{}:{}: found a quaternion of length {:.4g}, expected length 1", path,
                                   line.number, length));
    if (std::abs(length - 1.0) > kLengthRemarkable) normalised_length.note(line.number);
    ReadPose entry;
    entry.line = line.number;
    entry.pose.timestamp = n[0];
    entry.pose.world_from_camera.linear() = q.normalized().toRotationMatrix();
    entry.pose.world_from_camera.translation() = Eigen::Vector3d(n[1], n[2], n[3]);
    if (!read.empty() && n[0] < read.back().pose.timestamp) unsorted.note(line.number);
    read.push_back(entry);
  }
  if (read.empty()) throw InputError(fmt::format("{}: holds no poses, expected lines of {}", path, kColumns));

  std::stable_sort(read.begin(), read.end(),
                   [](const ReadPose& a, const ReadPose& b) { return a.pose.timestamp < b.pose.timestamp; });
  Trajectory trajectory;
  trajectory.reserve(read.size());
  for (const ReadPose& entry : read) {
    if (!trajectory.empty() && entry.pose.timestamp == trajectory.back().timestamp)
      repeated.note(entry.line);
    else
      trajectory.push_back(entry.pose);
  }
  unsorted.tell(warnings, path, "a pose is earlier than the one before it; poses were sorted by time");
  repeated.tell(warnings, path, "a pose repeats an earlier timestamp and was dropped");
  normalised_length.tell(warnings, path, "a quaternion is not of unit length and was normalised");
  return trajectory;
}

void write_tum_trajectory(const std::string& path, const Trajectory& trajectory) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d t = pose.world_from_camera.translation();
    const Eigen::Quaterniond q(pose.world_from_camera.linear());
    file << fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", pose.timestamp, t.x(),
                        t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  file.close();
  if (!file)
    throw InputError(fmt::format("{}: the trajectory cannot be written ({})", path, std::strerror(errno)));
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
