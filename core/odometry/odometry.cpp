#include "core/odometry/odometry.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/odometry/rolling_shutter.hpp"
#include "core/odometry/trust.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

constexpr int kMinFeaturesToBegin = 100;  // with depth: fewer make no map to track against

}  // namespace

Odometry::Odometry(const Camera& camera, const Config& config)
    : camera_(camera),
      config_(config),
      preparer_(camera, config),
      motion_(camera, config),
      scales_(octave_scales(config.features)) {}

FrameResult Odometry::process(const Frame& frame, const cv::Mat& known_mask) {
  const Stopwatch watch;
  PreparedFrame prepared;
  if (frame.readable()) prepared = preparer_.prepare(frame);
  const double preparation_ms = watch.milliseconds();
  FrameResult result = run_frame(frame, prepared, known_mask);
  result.record.ms.total += preparation_ms;
  return result;
}

FrameResult Odometry::process_prepared(const Frame& frame, PreparedFrame prepared,
                                       const cv::Mat& known_mask) {
  preparer_.motion().pass(prepared.motion);
  return run_frame(frame, prepared, known_mask);
}

FrameResult Odometry::run_frame(const Frame& frame, PreparedFrame& prepared, const cv::Mat& known_mask) {
  FrameResult result;
  FrameRecord& record = result.record;
  record.index = frame.index;
  record.timestamp = frame.timestamp;
  record.note = frame.problem;
  now_ = frame.timestamp;
  const Stopwatch whole;
  double check_ms = 0.0;  // no part of what the frame takes

  apply_due_bundle(record, false);
  if (!frame.readable()) {
    mark_lost(record, FrameStatus::unreadable, "the image could not be read");
  } else {
    record.ms.features = prepared.features_ms;
    record.ms.motion = prepared.motion_ms;
    MotionInput input{frame, prepared.motion};
    input.threads = config_.run.threads;
    const MotionNeeds& needs = motion_.info_for(frame).needs;
    if (needs.true_mask) input.true_mask = known_mask;
    if (!needs.first_pose) judge(input, result);
    if (config_.run.check_removal && last_) {
      const Stopwatch beside;
      record.removal_check = check_removal(frame, prepared, known_mask);
      check_ms = beside.milliseconds();
    }
    Current current = last_ ? track_frame(input, prepared, result) : initialise(frame, prepared, result);
    record.features = std::move(current.records);
    motion_.commit(input, result.motion, {record.estimated, record.world_from_camera.inverse()});
    if (aligns_directly()) remember_reference(frame, result);
  }
  record.map_points = static_cast<int>(map_.point_count());
  record.map_keyframes = static_cast<int>(map_.keyframes().size());
  record.ms.total = whole.milliseconds() - check_ms;
  return result;
}

/// METHOD.md §1, or what stands in its place: the method's judgement of the frame.
void Odometry::judge(const MotionInput& input, FrameResult& result) const {
  const Stopwatch watch;
  result.motion = motion_.detect(input);
  result.mask = result.motion.mask;
  FrameRecord& record = result.record;
  record.mask_share = result.motion.mask_share;
  record.motion_rounds = result.motion.rounds;
  const std::vector<FigureInfo>& infos = motion_.info_for(input.frame).figures;
  record.motion_figures.clear();
  for (std::size_t i = 0; i < result.motion.figures.size() && i < infos.size(); ++i)
    record.motion_figures.push_back({infos[i].name, result.motion.figures[i]});
  if (input.camera_from_world) record.motion_pose = input.camera_from_world;
  record.ms.motion += watch.milliseconds();
}

cv::Mat Odometry::prior_mask(const MotionInput& input, FrameRecord& record) const {
  const Stopwatch watch;
  record.prior_pose = input.camera_from_world;
  cv::Mat mask = motion_.prior_mask(input);
  record.ms.motion += watch.milliseconds();
  return mask;
}

std::vector<MotionFeature> Odometry::motion_features(const PreparedFrame& prepared,
                                                     const Current& first) const {
  std::vector<MotionFeature> features(prepared.pixels.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    features[i].pixel = prepared.pixels[i];
    features[i].depth = first.records[i].depth;
  }
  for (std::size_t f = 0; f < first.points.size(); ++f) {
    if (first.points[f] == kNone) continue;
    MotionFeature& feature = features[static_cast<std::size_t>(first.record_of[f])];
    feature.map_point = first.points[f];
    feature.world = map_.point(first.points[f]).position;
  }
  return features;
}

Odometry::Current Odometry::remove_moving(const Frame& frame, const PreparedFrame& prepared,
                                          const cv::Mat& mask, const Vector6d& velocity, FrameRecord& record,
                                          const MotionResult& motion) const {
  const OrbFeatures& found = prepared.found;
  const std::vector<cv::Point2f>& pixels = prepared.pixels;
  Current current;
  FeatureSet all;
  all.keypoints = found.keypoints;
  all.descriptors = found.descriptors;
  all.undistorted = prepared.undistorted;
  const double lag = depth_lag(frame);
  all.depth = lag == 0.0 ? depth_at(pixels, frame.depth)
                         : depth_at(pixels, all.undistorted, frame.depth, camera_, se3_exp(velocity * lag));
  if (config_.tracking.correct_rolling_shutter)
    correct_rolling_shutter(camera_, velocity, pixels, all.undistorted, all.depth);

  current.mask = mask;
  std::vector<std::uint8_t> keep(pixels.size(), 1);
  if (!mask.empty())
    for (std::size_t i = 0; i < keep.size(); ++i)
      keep[i] = mask.at<uchar>(cvRound(pixels[i].y), cvRound(pixels[i].x)) == 0;
  all.trust = trust_at(pixels, config_.tracking.soft_weights ? motion.log_odds : cv::Mat(), frame.gray.size(),
                       config_.tracking.half_trust_log_odds);
  if (motion.weight_of_feature.size() == keep.size())
    for (std::size_t i = 0; i < keep.size(); ++i) {
      if (motion.weight_of_feature[i] <= 0.0F) keep[i] = 0;
      all.trust[i] *= motion.weight_of_feature[i];
    }
  raise_least_trust(keep, all.trust);

  current.records.resize(keep.size());
  for (std::size_t i = 0; i < keep.size(); ++i) {
    FeatureRecord& feature = current.records[i];
    feature.pixel = pixels[i];
    feature.depth = all.depth[i];
    feature.octave = static_cast<std::uint8_t>(found.keypoints[i].octave);
    feature.trust = all.trust[i];
    if (keep[i])
      current.record_of.push_back(static_cast<int>(i));
    else
      feature.fate = FeatureFate::removed;
  }
  current.features = std::make_shared<const FeatureSet>(subset(all, keep, camera_.width, camera_.height));
  current.points.assign(current.record_of.size(), kNone);
  record.features_found = all.size();
  record.features_kept = current.features->size();
  record.features_removed = record.features_found - record.features_kept;
  return current;
}

Odometry::Current Odometry::initialise(const Frame& frame, const PreparedFrame& prepared,
                                       FrameResult& result) {
  FrameRecord& record = result.record;
  Current current = remove_moving(frame, prepared, result.mask, velocity_, record);
  const auto& depth = current.features->depth;
  const auto with_depth = std::count_if(depth.begin(), depth.end(), [](float z) { return z > 0; });
  if (with_depth < kMinFeaturesToBegin) {
    mark_lost(
        record, FrameStatus::lost,
        fmt::format("only {} features with depth; a map begins with {}", with_depth, kMinFeaturesToBegin));
    return current;
  }
  record.status = FrameStatus::initialised;
  record.estimated = true;
  add_keyframe(frame, current, record);
  remember(current, record);
  return current;
}

Odometry::Current Odometry::track_frame(MotionInput input, const PreparedFrame& prepared,
                                        FrameResult& result) {
  const Frame& frame = input.frame;
  FrameRecord& record = result.record;
  const MotionNeeds& needs = motion_.info_for(frame).needs;
  const bool judged_by_pose = motion_.info().needs.first_pose;
  Pose start = predicted_camera_from_world();
  Vector6d velocity = velocity_;
  bool agreed = false;
  if (judged_by_pose || !is_taken_at_once(frame)) {
    // A first pose: what moves under it, and how fast the camera goes in this very frame, are known only
    // then.
    if (needs.first_pose) {
      input.camera_from_world = start;
      result.mask = prior_mask(input, record);
    }
    Current first = remove_moving(frame, prepared, result.mask, velocity_, record);
    first.camera_from_world = first.start = start;
    first.seek_consensus = judged_by_pose && config_.tracking.seek_consensus;
    first.seed = static_cast<std::uint32_t>(config_.run.seed) + static_cast<std::uint32_t>(frame.index);
    bool begun = estimate(first, record);
    if (aligns_directly() && (begins_starved(first) || !begun))
      begun = begin_directly(frame, first, record) || begun;
    agreed = begun && first.agreed;
    if (begun) {
      start = first.camera_from_world;
      velocity = se3_log(start * last_camera_from_world().inverse()) / elapsed();
      if (needs.first_pose) {
        input.camera_from_world = start;
        const std::vector<MotionFeature> features =
            needs.matches ? motion_features(prepared, first) : std::vector<MotionFeature>();
        input.features = features;
        judge(input, result);
        purge_moving_points(frame, result.mask, start);
      }
    }
  }
  Current current = remove_moving(frame, prepared, result.mask, velocity, record, result.motion);
  current.camera_from_world = current.start = start;
  current.start_agreed = agreed;
  std::string why_lost;
  bool harms = judged_by_pose && leaves_too_little(current);
  if (!harms) {
    why_lost = track(frame, current, record);
    harms = judged_by_pose && !why_lost.empty() && record.features_removed > 0;
  }
  if (harms) {
    // Better a pose disturbed by what moves than none: the frame is tracked by all of its features, and the
    // judgement, which led here, is withdrawn.
    current = remove_moving(frame, prepared, {}, velocity, record);
    current.camera_from_world = current.start = start;
    current.start_agreed = agreed;
    why_lost = track(frame, current, record);
    result.mask.release();
    result.motion.mask.release();
    result.motion.weight_of_feature.clear();
    if (!result.motion.log_odds.empty())
      result.motion.log_odds = cv::Mat::zeros(result.motion.log_odds.size(), CV_32FC1);
    record.mask_share = 0.0;
    record.note += (record.note.empty() ? "" : "; ") +
                   std::string("too little is left without what moves, so nothing was removed");
  }
  if (!why_lost.empty()) mark_lost(record, FrameStatus::lost, why_lost);
  return current;
}

bool Odometry::is_taken_at_once(const Frame& frame) const {
  return (camera_.readout_s == 0.0 || !config_.tracking.correct_rolling_shutter) && depth_lag(frame) == 0.0;
}

int Odometry::inliers_needed() const {
  return lost_frames_ > 0 ? 2 * config_.tracking.min_inliers : config_.tracking.min_inliers;
}

bool Odometry::estimate(Current& current, FrameRecord& record) const {
  // After being lost the prediction is stale: the local map is searched everywhere at once.
  if (lost_frames_ == 0 && estimate_from_last(current, record)) return true;
  return estimate_by_epnp(current, record);
}

std::string Odometry::track(const Frame& frame, Current& current, FrameRecord& record) {
  const bool was_lost = lost_frames_ > 0;
  const int needed = inliers_needed();
  PoseRefinement refined;
  const bool begun = estimate(current, record);
  if (begun) refined = track_local_map(current, record);
  const bool directly = starves(refined.inliers) && refine_directly(frame, current, refined, record);
  // That a blurred frame does not show a point's corner tells nothing of the point.
  if (begun && !directly) count_sightings(current);
  if (!begun && !directly)
    return fmt::format("{} of {} features match the local map; {} must agree with a pose", record.matches,
                       record.features_kept, config_.tracking.min_initial_matches);
  if (refined.inliers < needed && !directly)
    return fmt::format("{} matches agree with the pose; {} are needed", refined.inliers, needed);
  record.status = was_lost ? FrameStatus::relocalised : FrameStatus::tracked;
  record.estimated = true;
  const Pose last = last_camera_from_world();
  velocity_ =
      was_lost ? Vector6d::Zero() : Vector6d(se3_log(current.camera_from_world * last.inverse()) / elapsed());
  lost_frames_ = 0;
  if (directly) ++starved_frames_;
  // Fading all the while: a view with fewer corners that lasts becomes the usual one.
  usual_inliers_ = std::max(kUsualFades * usual_inliers_, 1.0 * refined.inliers);
  const bool keyframe =
      directly ? is_starved_keyframe(frame, current) : wants_keyframe(frame, current, record);
  if (!directly || keyframe) starved_frames_ = 0;
  if (keyframe) add_keyframe(frame, current, record);
  // Points that so few corners show are looked for again from the frame that showed them well.
  if (refined.inliers < needed && !keyframe)
    remember_pose(current, record);
  else
    remember(current, record);
  if (looks_back()) {
    if (!keyframe && !directly) remember_sights(current, record);
    const Stopwatch watch;
    look_back(record.index - config_.tracking.look_back_frames);
    record.ms.pose += watch.milliseconds();
  }
  return {};
}

void Odometry::remember(const Current& current, FrameRecord& record) {
  Last last;
  last.features = current.features;
  last.points = current.points;
  const auto observers = map_.observers(current.points);
  last.reference_keyframe = observers.empty() ? map_.keyframes().rbegin()->first : observers.front().first;
  last.camera_from_reference =
      current.camera_from_world * map_.keyframe(last.reference_keyframe).camera_from_world.inverse();
  record.reference_keyframe = last.reference_keyframe;
  record.camera_from_reference = last.camera_from_reference;
  record.world_from_camera = current.camera_from_world.inverse();
  last_ = std::move(last);
  last_timestamp_ = now_;
}

void Odometry::mark_lost(FrameRecord& record, FrameStatus status, const std::string& why) {
  record.status = status;
  record.note += (record.note.empty() ? "" : "; ") + why;
  if (!last_) return;
  constexpr double kVelocityDecay = 0.8;  // a frame: nobody keeps moving the same way for long
  const Pose predicted = predicted_camera_from_world();
  record.world_from_camera = predicted.inverse();
  record.reference_keyframe = last_->reference_keyframe;
  last_->camera_from_reference = predicted * map_.pose_of(last_->reference_keyframe).inverse();
  record.camera_from_reference = last_->camera_from_reference;
  last_timestamp_ = now_;
  velocity_ *= kVelocityDecay;
  ++lost_frames_;
  starved_frames_ = 0;
}

Pose Odometry::last_camera_from_world() const {
  return last_->camera_from_reference * map_.pose_of(last_->reference_keyframe);
}

double Odometry::depth_lag(const Frame& frame) const {
  return config_.tracking.correct_depth_lag && frame.has_depth() ? frame.depth_timestamp - frame.timestamp
                                                                 : 0.0;
}

double Odometry::elapsed() const {
  constexpr double kShortest = 1e-3, kLongest = 0.2;  // s: beyond, a constant velocity predicts nothing
  return std::clamp(now_ - last_timestamp_, kShortest, kLongest);
}

Pose Odometry::predicted_camera_from_world() const {
  return se3_exp(velocity_ * elapsed()) * last_camera_from_world();
}

}  // namespace stillpoint
