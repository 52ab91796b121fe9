#include "core/run/run_sequence.hpp"

#include <algorithm>
#include <future>
#include <memory>
#include <opencv2/features2d.hpp>
#include <optional>
#include <unordered_map>

#include "core/byte_store.hpp"
#include "core/median.hpp"
#include "core/motion/methods.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/odometry/local_map.hpp"
#include "core/odometry/odometry.hpp"
#include "core/odometry/smoother.hpp"
#include "core/run/frame_records.hpp"
#include "core/run/tracked_poses.hpp"
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

/// Frames between two measurements of the unit: often enough to follow a machine whose speed drifts, seldom
/// enough not to be most of the time.
constexpr int kUnitEvery = 8;

/// Frames in order: read ahead on other threads, or, where time is measured, each when it is asked for, so
/// that nothing is decoded beside.
class ReadAhead {
 public:
  ReadAhead(const FrameSource& source, const RunOptions& options, int end, int threads) : source_(source) {
    if (!options.measure_orb_unit)
      prefetcher_ = std::make_unique<Prefetcher>(source, options.first, end, std::max(1, threads));
  }
  [[nodiscard]] Frame read(int index) const {
    return prefetcher_ ? prefetcher_->next() : source_.read(index);
  }

 private:
  const FrameSource& source_;
  std::unique_ptr<Prefetcher> prefetcher_;
};

/// A frame that is prepared while the one before it is tracked.
class PreparedNext {
 public:
  PreparedNext(Frame frame, FramePreparer& preparer, int threads) : frame_(std::move(frame)) {
    const bool beside = threads > 1;
    prepared_ =
        std::async(beside ? std::launch::async : std::launch::deferred, [frame = frame_, &preparer, beside] {
          return frame.readable() ? preparer.prepare(frame, beside) : PreparedFrame{};
        });
  }
  void wait() {
    const Stopwatch watch;
    prepared_.wait();
    waited_ms_ += watch.milliseconds();
  }
  [[nodiscard]] PreparedFrame get() {
    wait();
    return prepared_.get();
  }
  [[nodiscard]] const Frame& frame() const { return frame_; }
  /// What waiting for it took, reading excluded.
  [[nodiscard]] double waited_ms() const { return waited_ms_; }

 private:
  Frame frame_;
  std::future<PreparedFrame> prepared_;
  double waited_ms_ = 0.0;
};

/// LocalMap::pose_of for many keyframes: those that left the map are looked up, not looked for.
class KeyframePoses {
 public:
  explicit KeyframePoses(const LocalMap& map) : map_(&map) {
    for (const RetiredKeyframe& keyframe : map.retired()) retired_.emplace(keyframe.id, &keyframe);
  }
  [[nodiscard]] const Pose& of(int keyframe) {
    const auto [known, is_new] = poses_.try_emplace(keyframe, Pose::Identity());
    if (is_new) known->second = found(keyframe);
    return known->second;
  }

 private:
  /// In pose_of's order of factors: the same to the last bit.
  [[nodiscard]] Pose found(int keyframe) const {
    Pose camera_from_ancestor = Pose::Identity();
    for (auto at = retired_.find(keyframe); at != retired_.end(); at = retired_.find(keyframe)) {
      camera_from_ancestor = camera_from_ancestor * at->second->camera_from_anchor;
      if (at->second->anchor == kNone) return camera_from_ancestor;
      keyframe = at->second->anchor;
    }
    return camera_from_ancestor * map_->pose_of(keyframe);
  }

  const LocalMap* map_;
  std::unordered_map<int, const RetiredKeyframe*> retired_;
  std::unordered_map<int, Pose> poses_;
};

}  // namespace

std::vector<SavedKeyframe> saved_keyframes(const LocalMap& map) {
  std::vector<SavedKeyframe> saved;
  KeyframePoses poses(map);
  for (const auto& [id, keyframe] : map.keyframes())
    saved.push_back({id, keyframe.frame_index, {keyframe.timestamp, keyframe.camera_from_world.inverse()}});
  for (const RetiredKeyframe& retired : map.retired())
    saved.push_back({retired.id, retired.frame_index, {retired.timestamp, poses.of(retired.id).inverse()}});
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

/// The colours that map points are seen in, by id.
class PointColours {
 public:
  void see(const Frame& frame, const std::vector<FeatureRecord>& features) {
    const cv::Mat& image = frame.colour.empty() ? frame.gray : frame.colour;
    for (const FeatureRecord& feature : features) {
      if (feature.map_point == kNone || feature.fate != FeatureFate::inlier) continue;
      const cv::Point at(cvRound(feature.pixel.x), cvRound(feature.pixel.y));
      if (!cv::Rect(cv::Point(), image.size()).contains(at)) continue;
      colours_[feature.map_point] =
          image.channels() == 3 ? image.at<cv::Vec3b>(at) : cv::Vec3b::all(image.at<std::uint8_t>(at));
    }
  }
  /// Forgets those of points that left the map, once there are many of them.
  void forget(const LocalMap& map) {
    if (colours_.size() < 2 * map.point_count() + kFew) return;
    std::erase_if(colours_, [&map](const auto& seen) { return !map.has_point(seen.first); });
  }
  void give(std::vector<SavedPoint>& points) const {
    for (SavedPoint& point : points)
      if (const auto seen = colours_.find(point.id); seen != colours_.end()) point.colour = seen->second;
  }

 private:
  // Colours: below, keeping them costs less than looking for those to forget.
  static constexpr std::size_t kFew = 10000;
  std::unordered_map<int, cv::Vec3b> colours_;
};

std::vector<SavedPoint> moved_points(const LocalMap& map) {
  std::vector<SavedPoint> points;
  for (const MovedPoint& point : map.moved_points())
    points.push_back({.id = point.id, .position = point.position, .observations = 0, .moved = true});
  return points;
}

namespace {

StampedPose pose_now(double timestamp, int frame, const KeyframeRelativePose& tracked,
                     const Odometry& odometry, KeyframePoses& keyframes) {
  const KeyframeRelativePose pose = odometry.revised_poses().of(frame).value_or(tracked);
  const Pose camera_from_world = pose.camera_from_reference * keyframes.of(pose.reference_keyframe);
  return {timestamp, normalised(camera_from_world.inverse())};
}

}  // namespace

Trajectory trajectory_so_far(const Odometry& odometry, const FrameRecords& records) {
  Trajectory trajectory;
  trajectory.reserve(records.size());
  KeyframePoses keyframes(odometry.map());
  for (const FrameRecord& record : records)
    if (record.estimated)
      trajectory.push_back(pose_now(record.timestamp, record.index,
                                    {record.reference_keyframe, record.camera_from_reference}, odometry,
                                    keyframes));
  return trajectory;
}

void add_pose(const FrameRecord& record, TrackedPoses& poses) {
  if (!record.estimated) return;
  TrackedPose pose{record.timestamp, record.index, record.reference_keyframe, {}};
  Eigen::Map<Eigen::Matrix<double, 3, 4>>(pose.camera_from_reference.data()) =
      record.camera_from_reference.matrix().topRows<3>();
  poses.push_back(pose);
}

Trajectory trajectory_so_far(const Odometry& odometry, const TrackedPoses& poses) {
  Trajectory trajectory;
  trajectory.reserve(poses.size());
  KeyframePoses keyframes(odometry.map());
  for (const TrackedPose& one : poses) {
    KeyframeRelativePose tracked{one.reference_keyframe, Pose::Identity()};
    tracked.camera_from_reference.matrix().topRows<3>() =
        Eigen::Map<const Eigen::Matrix<double, 3, 4>>(one.camera_from_reference.data());
    trajectory.push_back(pose_now(one.timestamp, one.frame, tracked, odometry, keyframes));
  }
  return trajectory;
}

RunResult run_sequence(const FrameSource& source, const Config& config, const RunOptions& options) {
  RunResult result;
  result.config = config;
  result.frames_in_sequence = source.size();
  const int end = options.count > 0 ? std::min(source.size(), options.first + options.count) : source.size();
  const bool told = method_of(config).needs.true_mask || config.run.check_removal;

  const ReadAhead reader(source, options, end, config.run.threads);
  auto odometry = std::make_unique<Odometry>(source.camera(), config);
  FramePreparer preparer(source.camera(), config);
  const auto begin = [&](int index) {
    return PreparedNext(reader.read(index), preparer, config.run.threads);
  };
  const std::shared_ptr<ByteStore> store = ByteStore::make();
  result.records = records_put_by(store);
  result.scores = scores_put_by(store);
  std::vector<double> units;
  PointColours colours;
  std::optional<PreparedNext> next;
  if (options.first < end) next.emplace(begin(options.first));
  for (int index = options.first; index < end; ++index) {
    if (options.stop && *options.stop) {
      result.interrupted = true;
      break;
    }
    // The truth is read beside tracking; only who is told of it waits for it.
    auto truth = std::async(told ? std::launch::deferred : std::launch::async, [&source, index] {
      return source.has_masks() ? source.truth(index).moving : cv::Mat();
    });
    const cv::Mat known = told ? truth.get() : cv::Mat();
    PreparedFrame prepared = next->get();
    const double waited_ms = next->waited_ms();
    const Frame frame = next->frame();
    next.reset();
    if (source.has_depth() && frame.readable() && !frame.has_depth())
      result.without_depth.push_back({index, frame.problem});
    if (index + 1 < end) next.emplace(begin(index + 1));
    FrameResult processed = odometry->process_prepared(frame, std::move(prepared), known);
    processed.record.ms.total += waited_ms;
    result.scores.push_back(
        score_frame(processed, told ? known : truth.get(), method_of(config).judges_features));
    if (options.measure_orb_unit && frame.readable() && index % kUnitEvery == 0) {
      if (next) next->wait();  // nothing may run beside, and what the wait takes is the next frame's
      units.push_back(orb_unit_ms(frame.gray));
    }
    colours.see(frame, processed.record.features);
    colours.forget(odometry->map());
    if (options.on_frame) options.on_frame(processed);
    // Assigning nothing would keep the memory.
    if (!options.keep_features) processed.record.features = std::vector<FeatureRecord>();
    result.records.push_back(std::move(processed.record));
  }
  result.orb_unit_ms = median_of(units);
  odometry->finish();
  result.trajectory = trajectory_so_far(*odometry, result.records);
  result.keyframes = saved_keyframes(odometry->map());
  result.points = saved_points(odometry->map());
  colours.give(result.points);
  result.moved = moved_points(odometry->map());
  // What is made of all frames from here on has the room that the map had.
  odometry.reset();
  result.live.reserve(result.trajectory.size());
  for (const FrameRecord& record : result.records)
    if (record.estimated) result.live.push_back({record.timestamp, record.world_from_camera});
  return result;
}

}  // namespace stillpoint
