#include "core/run/run_sequence.hpp"

#include <algorithm>
#include <future>
#include <opencv2/features2d.hpp>

#include "core/sequence/prefetch.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

/// EVALUATION.md's unit of speed: one detectAndCompute of 1000 features on this frame, by OpenCV and one
/// thread.
double orb_unit_ms(const cv::Mat& gray) {
  static const cv::Ptr<cv::ORB> orb = cv::ORB::create(1000, 1.2F, 8);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  const Stopwatch watch;
  orb->detectAndCompute(gray, cv::noArray(), keypoints, descriptors);
  return watch.milliseconds();
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<SavedKeyframe> saved_keyframes(const LocalMap& map) {
  std::vector<SavedKeyframe> saved;
  for (const auto& [id, keyframe] : map.keyframes())
    saved.push_back({id, keyframe.frame_index, {keyframe.timestamp, keyframe.camera_from_world.inverse()}});
  for (const RetiredKeyframe& retired : map.retired())
    saved.push_back(
        {retired.id, retired.frame_index, {retired.timestamp, map.pose_of(retired.id).inverse()}});
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

std::vector<SavedPoint> moved_points(const LocalMap& map) {
  std::vector<SavedPoint> points;
  for (const MovedPoint& point : map.moved_points())
    points.push_back({.id = point.id, .position = point.position, .observations = 0, .moved = true});
  return points;
}

Trajectory trajectory_so_far(const LocalMap& map, const std::vector<FrameRecord>& records) {
  Trajectory trajectory;
  for (const FrameRecord& record : records) {
    if (!record.estimated) continue;
    const Pose camera_from_world = record.camera_from_reference * map.pose_of(record.reference_keyframe);
    trajectory.push_back({record.timestamp, normalised(camera_from_world.inverse())});
  }
  return trajectory;
}

RunResult run_sequence(const FrameSource& source, const Config& config, const RunOptions& options) {
  RunResult result;
  result.config = config;
  result.frames_in_sequence = source.size();
  const int end = options.count > 0 ? std::min(source.size(), options.first + options.count) : source.size();
  const bool told = config.run.method == "oracle" || config.run.check_removal != 0;

  Odometry odometry(source.camera(), config);
  Prefetcher prefetcher(source, options.first, end, std::max(1, config.run.threads));
  std::vector<double> units;
  for (int index = options.first; index < end; ++index) {
    if (options.stop && *options.stop) {
      result.interrupted = true;
      break;
    }
    // The truth is read beside tracking; only who is told of it waits for it.
    auto truth = std::async(told ? std::launch::deferred : std::launch::async, [&source, index] {
      return source.has_masks() ? source.truth(index).moving : cv::Mat();
    });
    const Frame frame = prefetcher.next();
    const cv::Mat known = told ? truth.get() : cv::Mat();
    FrameResult processed = odometry.process(frame, known);
    result.scores.push_back(score_frame(processed, told ? known : truth.get()));
    if (options.measure_orb_unit && frame.readable()) units.push_back(orb_unit_ms(frame.gray));
    if (options.on_frame) options.on_frame(processed);
    if (!options.keep_features) processed.record.features = {};
    result.records.push_back(std::move(processed.record));
  }
  result.orb_unit_ms = median(std::move(units));
  odometry.finish();
  for (const FrameRecord& record : result.records)
    if (record.estimated) result.live.push_back({record.timestamp, record.world_from_camera});
  result.trajectory = trajectory_so_far(odometry.map(), result.records);
  result.keyframes = saved_keyframes(odometry.map());
  result.points = saved_points(odometry.map());
  result.moved = moved_points(odometry.map());
  return result;
}

}  // namespace stillpoint
