#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/trajectory.hpp"
#include "core/odometry/map_id.hpp"

namespace stillpoint {

class LocalMap;

/// A map point as a run leaves it.
struct SavedPoint {
  int id = kNone;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, world
  int observations = 0;                                ///< keyframes that see it
  bool moved = false;                                  ///< it left the map because it was found to move
  cv::Vec3b colour{128, 128, 128};  ///< BGR, as it was last seen as an inlier; grey where that is not known
};

/// A keyframe as a run leaves it.
struct SavedKeyframe {
  int id = kNone, frame_index = 0;
  StampedPose pose;
};

/// All keyframes of a map, those that left it included, in order of time.
[[nodiscard]] std::vector<SavedKeyframe> saved_keyframes(const LocalMap& map);

/// All points of a map, by id.
[[nodiscard]] std::vector<SavedPoint> saved_points(const LocalMap& map);

/// The points that left a map because they moved, oldest first.
[[nodiscard]] std::vector<SavedPoint> moved_points(const LocalMap& map);

}  // namespace stillpoint
