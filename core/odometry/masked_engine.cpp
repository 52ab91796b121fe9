#include "core/odometry/masked_engine.hpp"

#include <cmath>
#include <limits>

#include "core/odometry/engines.hpp"
#include "core/odometry/frame_judgement.hpp"
#include "core/odometry/static_weight.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

/// The method's weights of points, by map point, where it judges points.
std::unordered_map<int, float> weights_of_points(const std::vector<MotionFeature>& features,
                                                 const std::vector<float>& weights) {
  std::unordered_map<int, float> of_point;
  if (weights.size() != features.size()) return of_point;
  for (std::size_t i = 0; i < features.size(); ++i)
    if (features[i].map_point != kNone) of_point[features[i].map_point] = weights[i];
  return of_point;
}

/// A tracker's points, for methods that judge points.
std::vector<MotionFeature> points_to_judge(const TrackerResult& first, const LocalMap& map) {
  std::vector<MotionFeature> features(first.features.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    const FeatureRecord& seen = first.features[i];
    features[i].pixel = seen.pixel;
    features[i].depth = seen.depth;
    if (seen.map_point == kNone || !map.has_point(seen.map_point)) continue;
    features[i].map_point = seen.map_point;
    features[i].world = map.point(seen.map_point).position;
  }
  return features;
}

}  // namespace

bool TrackerFrame::is_dynamic(const Eigen::Vector2d& pixel, double z) const {
  constexpr double kLikeDepth = 0.1;  // m, as for the points of the features' map
  if (!cull_dynamic || weight.empty() || depth.empty()) return false;
  const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
  if (x < 0 || y < 0 || x >= weight.cols || y >= weight.rows || weight.at<float>(y, x) > 0.0F) return false;
  const float sensed = depth.at<float>(y, x);
  const double there = static_cast<double>(sensed);
  return sensed > 0.0F && z < there + kLikeDepth + stereo_per_m2 * there * there;
}

MaskedEngine::MaskedEngine(const Camera& camera, const Config& config, std::unique_ptr<FrameTracker> tracker)
    : camera_(camera),
      config_(config),
      preparer_(camera, config),
      motion_(camera, config),
      rectifier_(camera),
      tracker_(std::move(tracker)) {}

MaskedEngine::MaskedEngine(const MaskedEngine& other)
    : OdometryEngine(other),
      camera_(other.camera_),
      config_(other.config_),
      preparer_(other.preparer_),
      motion_(other.motion_),
      rectifier_(other.rectifier_),
      tracker_(other.tracker_->clone()),
      path_(other.path_) {}

FrameResult MaskedEngine::process(const Frame& frame, const cv::Mat& known_mask) {
  const Stopwatch watch;
  PreparedFrame prepared;
  if (frame.readable()) prepared = preparer_.prepare(frame);
  const double preparation_ms = watch.milliseconds();
  FrameResult result = run_frame(frame, prepared, known_mask);
  result.record.ms.total += preparation_ms;
  return result;
}

FrameResult MaskedEngine::process_prepared(const Frame& frame, PreparedFrame prepared,
                                           const cv::Mat& known_mask) {
  preparer_.motion().pass(prepared.motion);
  return run_frame(frame, prepared, known_mask);
}

FrameResult MaskedEngine::run_frame(const Frame& frame, const PreparedFrame& prepared,
                                    const cv::Mat& known_mask) {
  FrameResult result;
  FrameRecord& record = result.record;
  record.index = frame.index;
  record.timestamp = frame.timestamp;
  record.note = frame.problem;
  record.measured = engine_of(config_).measures;
  const Stopwatch whole;
  double beside_ms = 0.0;
  point_weight_.clear();

  if (!frame.readable()) {
    lose(frame, FrameStatus::unreadable, "the image could not be read", std::nullopt, record);
  } else {
    record.ms.motion = prepared.motion_ms;
    if (frame.stereo) record.ms.stereo = frame.stereo->ms;
    const Stopwatch preparing;
    Rectified rectified{rectifier_.smooth(frame.gray), rectifier_.nearest(frame.depth), nullptr};
    rectified.prepared = tracker_->prepare(rectified.gray, rectified.depth);
    record.ms.features = preparing.milliseconds();
    MotionInput input{frame, prepared.motion};
    input.threads = config_.run.threads;
    const MotionNeeds& needs = motion_.info_for(frame).needs;
    if (needs.true_mask) input.true_mask = known_mask;
    if (!needs.first_pose) judge(motion_, input, result);
    TrackerResult tracked;
    if (!path_.begun()) {
      TrackerFrame first = looked_at(frame, rectified, result.mask, result.motion);
      tracked = tracker_->begin(first, record);
      if (tracked.found()) {
        record.status = FrameStatus::initialised;
        record.estimated = record.keyframe = true;
        TrackedFrame at;
        at.camera_from_world = tracked.camera_from_world;
        path_.follow(at, tracker_->map(), frame.timestamp);
        write_pose(tracked.camera_from_world, record);
      } else {
        lose(frame, FrameStatus::lost, tracked.why_lost, std::nullopt, record);
      }
    } else {
      tracked = track_frame(input, rectified, result);
      if (config_.run.check_removal) {
        const Stopwatch beside;
        record.removal_check = check(frame, rectified, result.motion, known_mask);
        beside_ms = beside.milliseconds();  // no part of what the frame takes
      }
      const TrackerFrame kept = looked_at(frame, rectified, result.mask, result.motion);
      if (tracked.found()) {
        keep(kept, tracked, record);
      } else {
        tracker_->lose(kept, tracked);
        lose(frame, FrameStatus::lost, tracked.why_lost, tracked.held, record);
      }
    }
    write_result(tracked, result);
    motion_.commit(input, result.motion, {record.estimated, record.world_from_camera.inverse()});
  }
  record.map_points = static_cast<int>(tracker_->map().point_count());
  record.map_keyframes = static_cast<int>(tracker_->map().keyframes().size());
  record.ms.total += whole.milliseconds() - beside_ms;
  return result;
}

TrackerFrame MaskedEngine::looked_at(const Frame& frame, const Rectified& rectified, const cv::Mat& mask,
                                     const MotionResult& motion) const {
  TrackerFrame looked{frame, rectified.gray, rectified.depth, {}, point_weight_};
  looked.threads = config_.run.threads;
  looked.prepared = rectified.prepared;
  looked.cull_dynamic = config_.map.cull_dynamic && !mask.empty();
  looked.velocity = path_.velocity();
  looked.stereo_per_m2 = camera_.depth_sigma_per_m2;
  if (path_.begun() && !path_.lost())
    looked.velocity_to = [this, now = frame.timestamp](const Pose& camera_from_world) {
      return path_.velocity_to(camera_from_world, tracker_->map(), now);
    };
  if (config_.tracking.correct_depth_lag && frame.has_depth())
    looked.depth_lag = frame.depth_timestamp - frame.timestamp;
  const bool weighed =
      engine_of(config_).takes_weights && config_.tracking.soft_weights && !motion.log_odds.empty();
  if (mask.empty() && !weighed && rectifier_.seen().empty()) return looked;
  cv::Mat weight =
      weighed ? static_weight_image(motion.log_odds, frame.gray.size(), config_.tracking.half_weight_log_odds)
              : cv::Mat(frame.gray.size(), CV_32FC1, cv::Scalar(1.0F));
  if (!mask.empty()) weight.setTo(0.0F, mask);
  looked.weight = rectifier_.nearest(weight);
  return looked;
}

/// The method's judgement, under a first pose where it wants one, and then the pose from what is left.
TrackerResult MaskedEngine::track_frame(MotionInput input, const Rectified& rectified, FrameResult& result) {
  const Frame& frame = input.frame;
  FrameRecord& record = result.record;
  const MotionNeeds& needs = motion_.info_for(frame).needs;
  Pose start = path_.predicted(tracker_->map(), frame.timestamp);
  bool estimated = false;
  const auto track = [&](const cv::Mat& mask, const MotionResult& motion, const Pose& from) {
    const Stopwatch watch;
    TrackerFrame looked = looked_at(frame, rectified, mask, motion);
    looked.start_estimated = estimated;
    TrackerResult tracked = tracker_->track(looked, from);
    record.ms.pose += watch.milliseconds();
    return tracked;
  };
  if (needs.first_pose) {
    input.camera_from_world = start;
    expect(motion_, input, result);
    const TrackerResult first = track(result.mask, {}, start);
    if (first.found()) {
      input.camera_from_world = start = first.camera_from_world;
      estimated = true;
      const auto points =
          needs.matches ? points_to_judge(first, tracker_->map()) : std::vector<MotionFeature>();
      input.features = points;
      judge(motion_, input, result);
      point_weight_ = weights_of_points(points, result.motion.weight_of_feature);
    }
  }
  TrackerResult tracked = track(result.mask, result.motion, start);
  if (tracked.found() || !needs.first_pose || result.mask.empty()) return tracked;
  // Better a pose disturbed by what moves than none.
  point_weight_.clear();
  TrackerResult whole = track({}, {}, start);
  if (!whole.found()) return tracked;
  withdraw(result);
  return whole;
}

RemovalCheck MaskedEngine::check(const Frame& frame, const Rectified& rectified, const MotionResult& motion,
                                 const cv::Mat& known_mask) const {
  const bool judged_by_pose = motion_.info_for(frame).needs.first_pose;
  MotionResult weights;
  weights.log_odds = motion.log_odds;
  const auto solve = [&](const cv::Mat& mask) -> std::optional<Pose> {
    Pose start = path_.predicted(tracker_->map(), frame.timestamp);
    bool estimated = false;
    if (judged_by_pose) {
      TrackerFrame looked = looked_at(frame, rectified, mask, {});
      looked.point_weight.clear();
      const TrackerResult first = tracker_->track(looked, start);
      estimated = first.found();
      if (estimated) start = first.camera_from_world;
    }
    TrackerFrame looked = looked_at(frame, rectified, mask, weights);
    looked.start_estimated = estimated;
    for (auto& [point, weight] : looked.point_weight)
      if (weight <= 0.0F) weight = 1.0F;
    const TrackerResult tracked = tracker_->track(looked, start);
    if (!tracked.found()) return std::nullopt;
    return tracked.camera_from_world.inverse();
  };
  RemovalCheck solved;
  solved.nothing_removed = solve({});
  if (known_mask.size() == frame.gray.size()) solved.truth_removed = solve(known_mask);
  return solved;
}

void MaskedEngine::keep(const TrackerFrame& frame, TrackerResult& tracked, FrameRecord& record) {
  const Stopwatch watch;
  const double now = frame.image.timestamp;
  record.status = path_.lost() ? FrameStatus::relocalised : FrameStatus::tracked;
  record.estimated = true;
  path_.measure(tracked.camera_from_world, tracker_->map(), now);
  TrackerFrame with_velocity = frame;
  with_velocity.velocity = path_.velocity();
  tracker_->keep(with_velocity, tracked, record);
  TrackedFrame at;
  at.camera_from_world = tracked.camera_from_world;
  path_.follow(at, tracker_->map(), now);
  write_pose(tracked.camera_from_world, record);
  record.ms.mapping += watch.milliseconds();
}

void MaskedEngine::lose(const Frame& frame, FrameStatus status, const std::string& why,
                        const std::optional<Pose>& held, FrameRecord& record) {
  record.status = status;
  record.note += (record.note.empty() ? "" : "; ") + why;
  if (!path_.begun()) return;
  const LocalMap& map = tracker_->map();
  const Pose pose = held ? *held : path_.predicted(map, frame.timestamp);
  if (held)
    path_.lose_at(pose, map, frame.timestamp);
  else
    path_.lose(map, frame.timestamp);
  write_pose(pose, record);
}

void MaskedEngine::write_pose(const Pose& camera_from_world, FrameRecord& record) const {
  record.reference_keyframe = path_.last().reference_keyframe;
  record.camera_from_reference = path_.last().camera_from_reference;
  record.world_from_camera = camera_from_world.inverse();
}

void MaskedEngine::write_result(TrackerResult& tracked, FrameResult& result) const {
  FrameRecord& record = result.record;
  record.pose_start =
      tracked.found() && record.status != FrameStatus::initialised ? tracked.start : PoseStart::none;
  record.matches = tracked.matches;
  record.inliers = tracked.inliers;
  record.rms_px = tracked.rms_px;
  record.refine_iterations = tracked.iterations;
  record.features_found = static_cast<int>(tracked.features.size());
  for (const FeatureRecord& feature : tracked.features)
    record.features_removed += feature.fate == FeatureFate::removed ? 1 : 0;
  record.features_kept = record.features_found - record.features_removed;
  record.features = std::move(tracked.features);
  const std::vector<FigureInfo>& infos = engine_of(config_).figures;
  for (std::size_t i = 0; i < tracked.figures.size() && i < infos.size(); ++i)
    record.motion_figures.push_back({infos[i].name, tracked.figures[i]});
  result.engine = std::move(tracked.trace);
}

void MaskedEngine::drop_images() {
  preparer_.motion().forget();
  motion_.drop_images();
}

void MaskedEngine::restore_images(int next, const std::function<Frame(int)>& read) {
  preparer_.motion().restore(next, config_.run.threads, read);
  motion_.restore_images(next, std::numeric_limits<int>::max(), read);
}

std::unique_ptr<OdometryEngine> MaskedEngine::continued_with(const Config& config,
                                                             const std::vector<PastFrame>& before) const {
  if (config.run.odometry != config_.run.odometry || !why_no_pair(config).empty()) return nullptr;
  auto next = std::make_unique<MaskedEngine>(*this);
  if (!next->tracker_->adopt(config)) return nullptr;
  next->config_ = config;
  next->preparer_ = FramePreparer(camera_, config);
  next->motion_ = motion_.continued_with(config, before);
  if (frames_wanted(config) == 0) {
    for (const auto& preparation : preparer_.motion().past()) next->preparer_.motion().pass(preparation);
  } else {
    for (const PastFrame& past : before)
      if (past.frame.readable()) (void)next->preparer_.motion().prepare(past.frame, config.run.threads);
  }
  return next;
}

}  // namespace stillpoint
