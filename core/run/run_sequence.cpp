#include "core/run/run_sequence.hpp"

#include <algorithm>
#include <future>

#include "core/sequence/prefetch.hpp"

namespace stillpoint {
namespace {

std::vector<SavedKeyframe> saved_keyframes(const LocalMap& map) {
  std::vector<SavedKeyframe> saved;
  for (const auto& [id, keyframe] : map.keyframes())
    saved.push_back({id, keyframe.frame_index, {keyframe.timestamp, keyframe.camera_from_world.inverse()}});
  for (const RetiredKeyframe& retired : map.retired())
    saved.push_back({retired.id, retired.frame_index, {retired.timestamp, map.pose_of(retired.id).inverse()}});
  std::sort(saved.begin(), saved.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return saved;
}

std::vector<SavedPoint> saved_points(const LocalMap& map) {
  std::vector<SavedPoint> saved;
  for (const int id : map.point_ids()) {
    const MapPoint& point = map.point(id);
    saved.push_back({id, point.position, static_cast<int>(point.observations.size())});
  }
  return saved;
}

void collect_trajectories(const LocalMap& map, RunResult& result) {
  for (const FrameRecord& record : result.records) {
    if (!record.estimated) continue;
    result.live.push_back({record.timestamp, record.world_from_camera});
    const Pose camera_from_world = record.camera_from_reference * map.pose_of(record.reference_keyframe);
    result.trajectory.push_back({record.timestamp, normalised(camera_from_world.inverse())});
  }
}

}  // namespace

RunResult run_sequence(const FrameSource& source, const Config& config, const RunOptions& options) {
  RunResult result;
  result.config = config;
  result.frames_in_sequence = source.size();
  const int end = options.count > 0 ? std::min(source.size(), options.first + options.count) : source.size();
  const bool oracle = config.run.method == "oracle";

  Odometry odometry(source.camera(), config);
  Prefetcher prefetcher(source, options.first, end, std::max(1, config.run.threads));
  for (int index = options.first; index < end; ++index) {
    if (options.stop && *options.stop) {
      result.interrupted = true;
      break;
    }
    const Frame frame = prefetcher.next();
    FrameTruth truth;
    if (oracle || (options.on_frame && source.has_masks())) truth = source.truth(index);
    FrameResult frame_result = odometry.process(frame, oracle ? truth.moving : cv::Mat());
    if (options.on_frame) options.on_frame(frame_result, frame, truth);
    result.records.push_back(std::move(frame_result.record));
  }
  odometry.finish();
  collect_trajectories(odometry.map(), result);
  result.keyframes = saved_keyframes(odometry.map());
  result.points = saved_points(odometry.map());
  return result;
}

}  // namespace stillpoint
