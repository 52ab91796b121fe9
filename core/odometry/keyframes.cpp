// What becomes of a frame when it has been tracked: the part of Odometry that keeps the map, and poses by it.
#include <algorithm>
#include <limits>

#include "core/odometry/mapping.hpp"
#include "core/odometry/odometry.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {

void Odometry::finish() {
  FrameRecord unused;
  apply_due_bundle(unused, true);
  look_back(std::numeric_limits<int>::max());
}

void Odometry::apply_due_bundle(FrameRecord& record, bool now) {
  if (!pending_ || (!now && record.index < pending_->due)) return;
  const Stopwatch watch;
  const BundleSolution& solution = pending_->solution.get();
  apply_bundle(solution, map_);
  record.bundle_rms_before_px = solution.initial_rms_px;
  record.bundle_rms_px = solution.rms_px;
  record.bundle_iterations = solution.iterations;
  if (map_.has_keyframe(pending_->keyframe)) {
    for (const int point : map_.keyframe(pending_->keyframe).points)
      if (point != kNone) map_.update_point(point, config_.features.scale_factor, config_.features.levels);
    record.culled_keyframes += cull_keyframes(map_, pending_->keyframe, config_);
  }
  pending_.reset();
  record.ms.bundle += watch.milliseconds();
}

bool Odometry::wants_keyframe(const Frame& frame, const Current& current, const FrameRecord& record) const {
  // One adjustment at a time: a keyframe before the last one's is done would have to wait for it.
  if (!frame.has_depth() || pending_) return false;
  const FeatureSet& features = *current.features;
  int near_tracked = 0, near_new = 0;
  for (std::size_t i = 0; i < current.points.size(); ++i) {
    if (features.depth[i] <= 0 || features.depth[i] > config_.map.far_depth_m) continue;
    ++(current.points[i] != kNone ? near_tracked : near_new);
  }
  const bool near_wanted =
      near_tracked < config_.map.keyframe_min_near && near_new > config_.map.keyframe_new_near;

  const auto observers = map_.observers(current.points);
  if (observers.empty()) return false;
  // Points of the reference keyframe that have proved themselves: what there was to be tracked.
  const int proven = map_.keyframes().size() <= 2 ? 1 : 2;
  int reference_points = 0;
  for (const int point : map_.keyframe(observers.front().first).points)
    if (point != kNone && static_cast<int>(map_.point(point).observations.size()) >= proven)
      ++reference_points;
  const bool few_left = record.inliers < config_.map.keyframe_min_ratio * reference_points;
  const bool long_ago = frame.index - last_keyframe_frame_ >= config_.map.keyframe_max_gap;
  return few_left || near_wanted || (long_ago && near_new > config_.map.keyframe_new_near);
}

void Odometry::add_keyframe(const Frame& frame, Current& current, FrameRecord& record) {
  apply_due_bundle(record, true);
  // The adjustment may have taken points out of the map, and moved it under this frame.
  for (int& point : current.points)
    if (point != kNone && !map_.has_point(point)) point = kNone;

  const Stopwatch watch;
  Keyframe keyframe;
  keyframe.frame_index = frame.index;
  keyframe.timestamp = frame.timestamp;
  keyframe.camera_from_world = current.camera_from_world;
  keyframe.features = current.features;
  keyframe.points = current.points;
  const int id = map_.add_keyframe(std::move(keyframe));
  for (const int point : current.points)
    if (point != kNone) map_.update_point(point, config_.features.scale_factor, config_.features.levels);
  record.culled_points = cull_points(map_, id, config_);
  record.new_points = create_points(map_, id, camera_, config_);
  record.fused_points = fuse_neighbours(map_, id, camera_, config_);
  current.points = map_.keyframe(id).points;
  record.keyframe = true;
  last_keyframe_frame_ = frame.index;
  record.ms.mapping = watch.milliseconds();

  if (map_.keyframes().size() < 2) return;
  auto solve = [problem = make_bundle_problem(map_, id, config_), camera = camera_, bundle = config_.bundle,
                weight = config_.tracking.depth_weight]() mutable {
    return solve_bundle(std::move(problem), camera, bundle, weight);
  };
  // When the result enters the map is fixed by the frame's number, so that threads change nothing but the
  // time.
  pending_ = PendingBundle{
      std::async(config_.run.threads > 1 ? std::launch::async : std::launch::deferred, std::move(solve))
          .share(),
      id, frame.index + config_.bundle.apply_after_frames};
  if (config_.bundle.apply_after_frames == 0) {
    apply_due_bundle(record, true);
    current.camera_from_world = map_.pose_of(id);
    for (int& point : current.points)
      if (point != kNone && !map_.has_point(point)) point = kNone;
  }
}

bool Odometry::looks_back() const {
  return config_.tracking.look_back_frames > 0 && motion_.info().extends_odometry;
}

void Odometry::remember_sights(const Current& current, const FrameRecord& record) {
  std::vector<Hindsight::Sight> sights;
  const FeatureSet& features = *current.features;
  for (std::size_t f = 0; f < current.points.size(); ++f) {
    if (current.points[f] == kNone) continue;
    const cv::Point2f pixel = features.undistorted[f];
    const auto octave = static_cast<std::size_t>(features.keypoints[f].octave);
    sights.push_back({current.points[f], pixel.x, pixel.y, features.depth[f],
                      static_cast<float>(scales_[octave]), static_cast<float>(features.trust[f])});
  }
  hindsight_.remember(record.index, {record.reference_keyframe, record.camera_from_reference},
                      std::move(sights));
}

void Odometry::look_back(int last) { hindsight_.look_back(last, map_, camera_, config_.tracking); }

}  // namespace stillpoint
