#include "core/odometry/camera_path.hpp"

#include <algorithm>

namespace stillpoint {

double CameraPath::elapsed(double now) const {
  constexpr double kShortest = 1e-3, kLongest = 0.2;  // s: beyond, a constant velocity predicts nothing
  return std::clamp(now - last_timestamp_, kShortest, kLongest);
}

Pose CameraPath::last_camera_from_world(const LocalMap& map) const {
  return last_->camera_from_reference * map.pose_of(last_->reference_keyframe);
}

Pose CameraPath::predicted(const LocalMap& map, double now) const {
  return se3_exp(velocity_ * elapsed(now)) * last_camera_from_world(map);
}

Vector6d CameraPath::velocity_to(const Pose& camera_from_world, const LocalMap& map, double now) const {
  return se3_log(camera_from_world * last_camera_from_world(map).inverse()) / elapsed(now);
}

void CameraPath::measure(const Pose& camera_from_world, const LocalMap& map, double now) {
  velocity_ = lost() ? Vector6d(Vector6d::Zero()) : velocity_to(camera_from_world, map, now);
  lost_frames_ = 0;
}

void CameraPath::follow(const TrackedFrame& frame, const LocalMap& map, double now) {
  LastFrame last;
  last.features = frame.features;
  last.points = frame.points;
  const auto observers = map.observers(frame.points);
  last.reference_keyframe = observers.empty() ? map.keyframes().rbegin()->first : observers.front().first;
  last_ = std::move(last);
  follow_pose(frame.camera_from_world, map, now);
}

void CameraPath::follow_pose(const Pose& camera_from_world, const LocalMap& map, double now) {
  if (!map.has_keyframe(last_->reference_keyframe))
    last_->reference_keyframe = map.keyframes().rbegin()->first;
  last_->camera_from_reference =
      camera_from_world * map.keyframe(last_->reference_keyframe).camera_from_world.inverse();
  last_timestamp_ = now;
}

void CameraPath::lose(const LocalMap& map, double now) {
  constexpr double kVelocityDecay = 0.8;  // a frame: nobody keeps moving the same way for long
  last_->camera_from_reference = predicted(map, now) * map.pose_of(last_->reference_keyframe).inverse();
  last_timestamp_ = now;
  velocity_ *= kVelocityDecay;
  ++lost_frames_;
}

void CameraPath::lose_at(const Pose& camera_from_world, const LocalMap& map, double now) {
  follow_pose(camera_from_world, map, now);
  velocity_.setZero();
  ++lost_frames_;
}

}  // namespace stillpoint
