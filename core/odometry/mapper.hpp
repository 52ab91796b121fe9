#pragma once

#include <vector>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/odometry/bundle_adjustment.hpp"
#include "core/odometry/local_map.hpp"
#include "core/odometry/tracked_frame.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// Keeps the local map: keyframes, new points, fusion, culling, and METHOD.md §2.4, local bundle adjustment.
/// All that changes the map is here.
class Mapper {
 public:
  Mapper(const Camera& camera, const Config& config) : camera_(camera), config_(config) {}

  void adopt(const Config& config) { config_ = config; }
  [[nodiscard]] const LocalMap& map() const { return map_; }

  // LocalMap's, for copies that are put by.
  void shelve_features(ByteStore& store) { map_.shelve_features(store); }
  void drop_features() { map_.drop_features(); }
  void restore_features() { map_.restore_features(); }

  /// Takes the map points that lie on what is dynamic out of the map. @param mask CV_8UC1, 255 = dynamic;
  /// empty: nothing does. @param about keyframe near which the camera is
  void remove_dynamic_points(const Frame& image, const cv::Mat& mask, const Pose& camera_from_world,
                             int about);
  /// Counts for each map point that should be seen that it should, and whether it was.
  void count_sightings(const std::vector<int>& in_view, const std::vector<int>& found);

  /// Whether a frame shows enough that the map does not hold. @param inliers of its pose
  [[nodiscard]] bool wants_keyframe(const Frame& image, const TrackedFrame& frame, int inliers) const;
  /// Whether a frame that few matches tie to the map can be a keyframe nevertheless.
  [[nodiscard]] bool bears_keyframe(const Frame& image, const TrackedFrame& frame) const;
  /// Makes the frame a keyframe and has the map about it adjusted. The frame follows the map.
  void add_keyframe(const Frame& image, TrackedFrame& frame, FrameRecord& record);

 private:
  void adjust(int keyframe, FrameRecord& record);
  void forget_removed(TrackedFrame& frame) const;
  void update_points(const std::vector<int>& points);

  Camera camera_;
  Config config_;
  LocalMap map_;
  int last_keyframe_frame_ = 0;  // frame index of the newest keyframe
};

}  // namespace stillpoint
