#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/se3.hpp"
#include "core/odometry/feature_set.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {

/// A frame on its way through tracking: the features that are left of it, what they were matched to, and
/// where the camera is held to be. A value.
struct TrackedFrame {
  std::shared_ptr<const FeatureSet> features;  ///< static ones
  std::vector<int> points;                     ///< map point a feature, inliers of the pose only
  Pose camera_from_world = Pose::Identity();
  Pose start = Pose::Identity();       ///< camera_from_world, as tracking began
  std::vector<FeatureRecord> records;  ///< of all features, removed ones too
  std::vector<int> record_of;          ///< feature -> index into records
  cv::Mat mask;                        ///< what was removed; empty when nothing was
  bool agreed = false;                 ///< camera_from_world is a consensus of most matches
  /// The start is a consensus: what is far from it is not to draw the pose away.
  bool start_agreed = false;
  std::vector<int> points_in_view, points_found;  ///< map points that should be seen, and those that were

  void start_from(const Pose& pose, bool pose_agreed) {
    camera_from_world = start = pose;
    start_agreed = pose_agreed;
  }
  [[nodiscard]] bool lost_features() const { return record_of.size() != records.size(); }
};

}  // namespace stillpoint
