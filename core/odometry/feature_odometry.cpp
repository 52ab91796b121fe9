#include "core/odometry/feature_odometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/odometry/engines.hpp"
#include "core/odometry/frame_judgement.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {

FeatureOdometry::FeatureOdometry(const Camera& camera, const Config& config)
    : camera_(camera),
      config_(config),
      preparer_(camera, config),
      motion_(camera, config),
      solver_(camera, config),
      mapper_(camera, config) {}

FrameResult FeatureOdometry::process(const Frame& frame, const cv::Mat& known_mask) {
  const Stopwatch watch;
  PreparedFrame prepared;
  if (frame.readable()) prepared = preparer_.prepare(frame);
  const double preparation_ms = watch.milliseconds();
  FrameResult result = run_frame(frame, prepared, known_mask);
  result.record.ms.total += preparation_ms;
  return result;
}

FrameResult FeatureOdometry::process_prepared(const Frame& frame, PreparedFrame prepared,
                                              const cv::Mat& known_mask) {
  preparer_.motion().pass(prepared.motion);
  return run_frame(frame, prepared, known_mask);
}

FrameResult FeatureOdometry::run_frame(const Frame& frame, const PreparedFrame& prepared,
                                       const cv::Mat& known_mask) {
  FrameResult result;
  FrameRecord& record = result.record;
  record.index = frame.index;
  record.timestamp = frame.timestamp;
  record.note = frame.problem;
  const Stopwatch whole;

  if (!frame.readable()) {
    lose(frame, FrameStatus::unreadable, "the image could not be read", record);
  } else {
    record.ms.features = prepared.features_ms;
    record.ms.motion = prepared.motion_ms;
    if (frame.stereo) record.ms.stereo = frame.stereo->ms;
    MotionInput input{frame, prepared.motion};
    input.threads = config_.run.threads;
    const MotionNeeds& needs = motion_.info_for(frame).needs;
    if (needs.true_mask) input.true_mask = known_mask;
    if (!needs.first_pose) judge(motion_, input, result);  // §1
    TrackedFrame tracked = solver_.path().begun() ? track_frame(input, prepared, known_mask, result)
                                                  : begin_map(frame, prepared, result);
    record.features_found = static_cast<int>(tracked.records.size());
    record.features_kept = tracked.features->size();
    record.features_removed = record.features_found - record.features_kept;
    record.features = std::move(tracked.records);
    // A keyframe's pose in the map is no longer the one it was solved to.
    const Pose in_map = solver_.path().begun() ? solver_.path().last_camera_from_world(mapper_.map())
                                               : record.world_from_camera.inverse();
    motion_.commit(input, result.motion, {record.estimated, in_map});
    solver_.direct().remember(frame, record, result.mask, solver_.features().depth_lag(frame),
                              solver_.path().velocity());
  }
  record.map_points = static_cast<int>(mapper_.map().point_count());
  record.map_keyframes = static_cast<int>(mapper_.map().keyframes().size());
  record.ms.total += whole.milliseconds();
  return result;
}

TrackedFrame FeatureOdometry::begin_map(const Frame& frame, const PreparedFrame& prepared,
                                        FrameResult& result) {
  constexpr int kMinFeatures = 100;  // with depth: fewer make no map to track against
  FrameRecord& record = result.record;
  TrackedFrame tracked = solver_.features().select(frame, prepared, result.mask, solver_.path().velocity());
  const auto& depth = tracked.features->depth;
  const auto with_depth = std::count_if(depth.begin(), depth.end(), [](float z) { return z > 0; });
  if (with_depth < kMinFeatures) {
    lose(frame, FrameStatus::lost,
         fmt::format("only {} features with depth; a map begins with {}", with_depth, kMinFeatures), record);
    return tracked;
  }
  record.status = FrameStatus::initialised;
  record.estimated = true;
  mapper_.add_keyframe(frame, tracked, record);
  solver_.path().follow(tracked, mapper_.map(), frame.timestamp);
  write_pose(tracked.camera_from_world, record);
  return tracked;
}

/// METHOD.md §2, a step a line.
TrackedFrame FeatureOdometry::track_frame(MotionInput input, const PreparedFrame& prepared,
                                          const cv::Mat& known_mask, FrameResult& result) {
  const Frame& frame = input.frame;
  FrameRecord& record = result.record;
  const LocalMap& map = mapper_.map();
  const MotionNeeds& needs = motion_.info_for(frame).needs;
  std::optional<BeforeFrame> before;
  if (config_.run.check_removal) before = BeforeFrame{solver_, mapper_, motion_.settled()};

  // Where a constant velocity has the camera by now.
  FrameSolver::FirstPose first = solver_.predict(frame, map);
  if (solver_.needs_first_pose(frame)) {
    // What is dynamic under a first pose, and how fast the camera goes in this very frame, are known only
    // then.
    if (needs.first_pose) {
      input.camera_from_world = first.camera_from_world;
      expect(motion_, input, result);
    }
    first = solver_.first_pose(frame, prepared, result.mask, map, motion_.settled(), record);
    if (first.found && needs.first_pose) {
      input.camera_from_world = first.camera_from_world;
      const auto features = needs.matches ? motion_features(first.seen, map) : std::vector<MotionFeature>();
      input.features = features;
      judge(motion_, input, result);  // §1, for methods that judge under a pose
      mapper_.remove_dynamic_points(frame, result.mask, first.camera_from_world,
                                    solver_.path().last().reference_keyframe);
    }
  }
  // §2.1 the features that survive, §2.2 EPnP inside RANSAC, §2.3 eq. (5).
  FrameSolver::Solution solution =
      solver_.solve(frame, prepared, result.mask, result.motion, first, map, record);
  if (solution.withdrawn) withdraw(result);
  if (before)
    check(*before, frame, prepared, solution.withdrawn ? MotionResult{} : result.motion, known_mask, record);
  mapper_.count_sightings(solution.points_in_view, solution.points_found);
  if (solution.found())
    keep(frame, solution, record);  // §2.1 the local map, §2.4 local bundle adjustment
  else
    lose(frame, FrameStatus::lost, solution.why_lost, record);
  return std::move(solution.frame);
}

void FeatureOdometry::check(const BeforeFrame& before, const Frame& frame, const PreparedFrame& prepared,
                            const MotionResult& motion, const cv::Mat& known_mask,
                            FrameRecord& record) const {
  const Stopwatch beside;
  record.removal_check =
      check_removal(before, frame, prepared, motion, motion_.info_for(frame).needs.first_pose, known_mask,
                    config_.run.threads);
  record.ms.total -= beside.milliseconds();  // no part of what the frame takes
}

/// What becomes of a frame whose pose was found.
void FeatureOdometry::keep(const Frame& frame, FrameSolver::Solution& solution, FrameRecord& record) {
  TrackedFrame& tracked = solution.frame;
  CameraPath& path = solver_.path();
  DirectFallback& direct = solver_.direct();
  const bool enough = solution.inliers >= solver_.tracker().inliers_needed();
  record.status = path.lost() ? FrameStatus::relocalised : FrameStatus::tracked;
  record.estimated = true;
  path.measure(tracked.camera_from_world, mapper_.map(), frame.timestamp);
  direct.count(solution.inliers, solution.directly);

  const Pose solved = tracked.camera_from_world;  // what is recorded: by eq. (5), as what it is compared with
  const bool keyframe = solution.directly
                            ? direct.degraded_for_long() && mapper_.bears_keyframe(frame, tracked)
                            : mapper_.wants_keyframe(frame, tracked, record.inliers);
  if (keyframe) {
    direct.end_degradation();
    mapper_.add_keyframe(frame, tracked, record);  // §2.4, which moves the map, and this frame with it
  }
  // Points that so few corners show are looked for again from the frame that showed them well.
  if (enough || keyframe)
    path.follow(tracked, mapper_.map(), frame.timestamp);
  else
    path.follow_pose(tracked.camera_from_world, mapper_.map(), frame.timestamp);
  write_pose(solved, record);

  if (!looks_back()) return;
  if (!keyframe && !solution.directly)
    smoother_.remember(record.index, {record.reference_keyframe, record.camera_from_reference},
                       inlier_matches_of(tracked, solver_.tracker().scales()));
  const Stopwatch watch;
  smoother_.advance(record.index - config_.tracking.smoother_lag_frames, mapper_.map(), camera_,
                    config_.tracking);
  record.ms.pose += watch.milliseconds();
}

void FeatureOdometry::lose(const Frame& frame, FrameStatus status, const std::string& why,
                           FrameRecord& record) {
  record.status = status;
  record.note += (record.note.empty() ? "" : "; ") + why;
  CameraPath& path = solver_.path();
  if (!path.begun()) return;
  const Pose predicted = path.predicted(mapper_.map(), frame.timestamp);
  path.lose(mapper_.map(), frame.timestamp);
  write_pose(predicted, record);
  solver_.direct().end_degradation();
}

void FeatureOdometry::write_pose(const Pose& camera_from_world, FrameRecord& record) const {
  record.reference_keyframe = solver_.path().last().reference_keyframe;
  record.camera_from_reference = solver_.path().last().camera_from_reference;
  record.world_from_camera = camera_from_world.inverse();
}

bool FeatureOdometry::looks_back() const {
  return config_.tracking.smoother_lag_frames > 0 && motion_.info().extends_odometry;
}

void FeatureOdometry::finish() {
  smoother_.advance(std::numeric_limits<int>::max(), mapper_.map(), camera_, config_.tracking);
}

EngineInfo features_engine() {
  EngineInfo info;
  info.name = kDefaultEngine;
  info.title = "Features";
  info.summary = "ORB features against a local map: EPnP in RANSAC, eq. (5), local bundle adjustment.";
  info.citation = "Niu & Li 2019, after Mur-Artal & Tardós 2017";
  info.offers_matches = true;
  info.wants_orb = true;
  info.make = [](const Camera& camera, const Config& config) -> std::unique_ptr<OdometryEngine> {
    return std::make_unique<FeatureOdometry>(camera, config);
  };
  return info;
}

}  // namespace stillpoint
