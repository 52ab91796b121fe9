#pragma once

#include <array>

#include "core/chunked_list.hpp"
#include "core/geometry/trajectory.hpp"
#include "core/odometry/map_id.hpp"

namespace stillpoint {

class Odometry;
struct FrameRecord;

/// What a trajectory is made of: where a frame stood from its reference keyframe when it was tracked.
struct TrackedPose {
  double timestamp = 0.0;  ///< s
  int frame = 0, reference_keyframe = kNone;
  std::array<double, 12> camera_from_reference{};  ///< column by column, without the last row
};
/// In order of frames, those with an estimated pose.
using TrackedPoses = ChunkedList<TrackedPose>;

/// Takes a record's pose among them, where it has one.
void add_pose(const FrameRecord& record, TrackedPoses& poses);

/// The poses as the map stands now.
[[nodiscard]] Trajectory trajectory_so_far(const Odometry& odometry, const TrackedPoses& poses);

}  // namespace stillpoint
