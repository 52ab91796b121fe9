#include "core/odometry/mapper.hpp"

#include <algorithm>

#include "core/odometry/mapping.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {

void Mapper::remove_dynamic_points(const Frame& image, const cv::Mat& mask, const Pose& camera_from_world,
                                   int about) {
  if (config_.map.cull_dynamic)
    stillpoint::remove_dynamic_points(map_, image.depth, mask, camera_from_world, about, camera_, config_);
}

void Mapper::count_sightings(const std::vector<int>& in_view, const std::vector<int>& found) {
  for (const int id : in_view) ++map_.point(id).visible;
  for (const int id : found) ++map_.point(id).found;
}

bool Mapper::wants_keyframe(const Frame& image, const TrackedFrame& frame, int inliers) const {
  if (!image.has_depth()) return false;
  const FeatureSet& features = *frame.features;
  const double far = camera_.depth_limit(config_.map.far_depth_m);
  int near_tracked = 0, near_new = 0;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (features.depth[i] <= 0 || features.depth[i] > far) continue;
    ++(frame.points[i] != kNone ? near_tracked : near_new);
  }
  const bool near_wanted =
      near_tracked < config_.map.keyframe_min_near && near_new > config_.map.keyframe_new_near;

  const auto observers = map_.observers(frame.points);
  if (observers.empty()) return false;
  // Points of the reference keyframe that have proved themselves: what there was to be tracked.
  const int proven = map_.keyframes().size() <= 2 ? 1 : 2;
  int reference_points = 0;
  for (const int point : map_.keyframe(observers.front().first).points)
    if (point != kNone && static_cast<int>(map_.point(point).observations.size()) >= proven)
      ++reference_points;
  const bool few_left = inliers < config_.map.keyframe_min_ratio * reference_points;
  const bool long_ago = image.index - last_keyframe_frame_ >= config_.map.keyframe_max_gap;
  return few_left || near_wanted || (long_ago && near_new > config_.map.keyframe_new_near);
}

bool Mapper::bears_keyframe(const Frame& image, const TrackedFrame& frame) const {
  constexpr int kFeatures = 100;  // with depth: fewer make no keyframe to track against
  if (!image.has_depth()) return false;
  if (map_.observers(frame.points).empty()) return false;  // nothing would tie it to the map
  const auto& depth = frame.features->depth;
  return std::count_if(depth.begin(), depth.end(), [](float z) { return z > 0; }) >= kFeatures;
}

void Mapper::add_keyframe(const Frame& image, TrackedFrame& frame, FrameRecord& record) {
  const Stopwatch watch;
  Keyframe keyframe;
  keyframe.frame_index = image.index;
  keyframe.timestamp = image.timestamp;
  keyframe.camera_from_world = frame.camera_from_world;
  keyframe.features = frame.features;
  keyframe.points = frame.points;
  const int id = map_.add_keyframe(std::move(keyframe));
  update_points(frame.points);
  record.culled_points = cull_points(map_, id, config_);
  record.new_points = create_points(map_, id, camera_, config_);
  record.fused_points = fuse_neighbours(map_, id, camera_, config_);
  frame.points = map_.keyframe(id).points;
  record.keyframe = true;
  last_keyframe_frame_ = image.index;
  record.ms.mapping = watch.milliseconds();

  if (map_.keyframes().size() < 2) return;
  adjust(id, record);
  // The map has moved under this frame, and points may have left it.
  frame.camera_from_world = map_.pose_of(id);
  forget_removed(frame);
}

void Mapper::adjust(int keyframe, FrameRecord& record) {
  const Stopwatch watch;
  const BundleSolution solution = solve_bundle(make_bundle_problem(map_, keyframe, config_), camera_,
                                               config_.bundle, config_.tracking.depth_weight);
  apply_bundle(solution, map_);
  record.bundle_rms_before_px = solution.initial_rms_px;
  record.bundle_rms_px = solution.rms_px;
  record.bundle_iterations = solution.iterations;
  update_points(map_.keyframe(keyframe).points);
  record.culled_keyframes = cull_keyframes(map_, keyframe, camera_, config_);
  record.ms.bundle = watch.milliseconds();
}

void Mapper::forget_removed(TrackedFrame& frame) const {
  for (int& point : frame.points)
    if (point != kNone && !map_.has_point(point)) point = kNone;
}

void Mapper::update_points(const std::vector<int>& points) {
  for (const int point : points)
    if (point != kNone) map_.update_point(point, config_.features.scale_factor, config_.features.levels);
}

}  // namespace stillpoint
