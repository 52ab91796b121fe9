#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/geometry/se3.hpp"
#include "core/odometry/local_map.hpp"
#include "core/odometry/tracked_frame.hpp"

namespace stillpoint {

/// The frame before, as the next one needs it.
struct LastFrame {
  std::shared_ptr<const FeatureSet> features;
  std::vector<int> points;  ///< map point a feature, or kNone
  int reference_keyframe = kNone;
  Pose camera_from_reference = Pose::Identity();
};

/// Where the camera was last and how fast it goes: predicts where it is next by a constant velocity. A value.
/// Its pose hangs on a keyframe, so that it moves with the map. Times are timestamps in s.
class CameraPath {
 public:
  /// False until the map has begun; all below but follow() is asked only afterwards.
  [[nodiscard]] bool begun() const { return last_.has_value(); }
  [[nodiscard]] const LastFrame& last() const { return *last_; }
  /// Of the camera, a second: log(current_from_last) over the time between.
  [[nodiscard]] const Vector6d& velocity() const { return velocity_; }
  [[nodiscard]] bool lost() const { return lost_frames_ > 0; }

  /// s since the last frame, as far as a constant velocity predicts anything.
  [[nodiscard]] double elapsed(double now) const;
  [[nodiscard]] Pose last_camera_from_world(const LocalMap& map) const;
  [[nodiscard]] Pose predicted(const LocalMap& map, double now) const;
  [[nodiscard]] Vector6d velocity_to(const Pose& camera_from_world, const LocalMap& map, double now) const;

  /// The camera was found there: how fast it went, and that it is not lost.
  void measure(const Pose& camera_from_world, const LocalMap& map, double now);
  /// The frame is the last one from now on.
  void follow(const TrackedFrame& frame, const LocalMap& map, double now);
  /// Its pose is the last one, but points are still looked for from the frame that showed them well.
  void follow_pose(const Pose& camera_from_world, const LocalMap& map, double now);
  /// The camera was not found and is taken to be where it was predicted.
  void lose(const LocalMap& map, double now);
  /// … or is taken to stand there, and to have stopped.
  void lose_at(const Pose& camera_from_world, const LocalMap& map, double now);

 private:
  std::optional<LastFrame> last_;
  Vector6d velocity_ = Vector6d::Zero();
  double last_timestamp_ = 0.0;
  int lost_frames_ = 0;  // in a row
};

}  // namespace stillpoint
