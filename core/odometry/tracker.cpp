#include "core/odometry/tracker.hpp"

#include <algorithm>

#include "core/odometry/consensus.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

constexpr int kMinModelInliers = 10;  // matches that must agree before the motion model's pose is believed

}  // namespace

Tracker::Tracker(const Camera& camera, const Config& config)
    : camera_(camera), config_(config), scales_(octave_scales(config.features)) {}

int Tracker::inliers_needed() const {
  return path_.lost() ? 2 * config_.tracking.min_inliers : config_.tracking.min_inliers;
}

bool Tracker::estimate(const LocalMap& map, TrackedFrame& frame, FrameRecord& record,
                       std::optional<std::uint32_t> consensus_seed) const {
  // After being lost the prediction is stale: the local map is searched everywhere at once.
  if (!path_.lost() && estimate_from_last(map, frame, record, consensus_seed)) return true;
  return estimate_by_epnp(map, frame, record);
}

std::vector<Candidate> Tracker::points_of_last(const LocalMap& map, const Pose& predicted,
                                               double radius_px) const {
  const LastFrame& last = path_.last();
  std::vector<Candidate> candidates;
  candidates.reserve(last.points.size());
  for (std::size_t i = 0; i < last.points.size(); ++i) {
    const int id = last.points[i];
    if (id == kNone || !map.has_point(id)) continue;
    const Eigen::Vector3d p = predicted * map.point(id).position;
    if (p.z() < kNearestProjected) continue;
    const Eigen::Vector2d pixel = camera_.project(p);
    if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() >= camera_.width || pixel.y() >= camera_.height) continue;
    const cv::KeyPoint& seen = last.features->keypoints[i];
    candidates.push_back({id,
                          {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())},
                          static_cast<float>(radius_px * scales_[static_cast<std::size_t>(seen.octave)]),
                          seen.octave - 1,
                          seen.octave + 1,
                          &last.features->descriptors[i],
                          seen.angle});
  }
  return candidates;
}

bool Tracker::estimate_from_last(const LocalMap& map, TrackedFrame& frame, FrameRecord& record,
                                 std::optional<std::uint32_t> consensus_seed) const {
  const TrackingConfig& tracking = config_.tracking;
  const Pose predicted = frame.camera_from_world;
  for (const double radius : {tracking.search_radius_px, tracking.search_radius_wide_px}) {
    const Stopwatch watch;
    const std::vector<Match> matches = consistently_turned(match_in_windows(
        *frame.features, points_of_last(map, predicted, radius), tracking.match_max_distance, 1.0));
    record.ms.matching += watch.milliseconds();
    record.matches = static_cast<int>(matches.size());
    if (record.matches < tracking.min_initial_matches) continue;

    frame.camera_from_world = predicted;
    PoseRefinement refined = refine(map, frame, matches, start_gate(frame), record);
    if (refined.inliers < kMinModelInliers) continue;
    if (consensus_seed)
      seek_consensus(observations_of(map, frame, matches), predicted, *consensus_seed, refined, frame,
                     record);
    frame.camera_from_world = refined.camera_from_world;
    for (std::size_t i = 0; i < matches.size(); ++i)
      if (refined.inlier[i]) frame.points[static_cast<std::size_t>(matches[i].feature)] = matches[i].point;
    record.pose_start =
        radius == tracking.search_radius_px ? PoseStart::motion_model : PoseStart::wide_search;
    return true;
  }
  frame.camera_from_world = predicted;
  return false;
}

void Tracker::seek_consensus(const std::vector<PoseObservation>& observations, const Pose& predicted,
                             std::uint32_t seed, PoseRefinement& refined, TrackedFrame& frame,
                             FrameRecord& record) const {
  // Sets of three: where half the observations agree, none is of these alone once in 10¹¹ times.
  constexpr int kSamples = 200;
  const Stopwatch watch;
  const Consensus agreed =
      consensus_pose(camera_, observations, {predicted, refined.camera_from_world}, kSamples, seed);
  refined.camera_from_world = agreed.camera_from_world;
  refined.inlier = agreed.inlier;
  // Where blur moves most corners, few agree, and beside the truth.
  frame.agreed = 2 * agreed.inliers >= static_cast<int>(observations.size());
  const double took = watch.milliseconds();
  record.ms.consensus += took;
  record.ms.pose += took;
}

bool Tracker::estimate_by_epnp(const LocalMap& map, TrackedFrame& frame, FrameRecord& record) const {
  constexpr int kMaxDistance = 60;  // bits: without a window only close descriptors tell points apart
  constexpr double kRatio = 0.8;    // of the second best's distance, as Lowe has it
  Stopwatch watch;
  std::vector<Candidate> candidates;
  for (const int id : local_points(map, frame)) {
    Candidate candidate;
    candidate.point = id;
    candidate.descriptor = &map.point(id).descriptor;
    candidates.push_back(candidate);
  }
  const std::vector<Match> matches = match_everywhere(*frame.features, candidates, kMaxDistance, kRatio);
  record.ms.matching += watch.lap();
  record.matches = static_cast<int>(matches.size());

  const auto initial = initial_pose(camera_, observations_of(map, frame, matches), config_.tracking);
  const double took = watch.milliseconds();
  record.ms.epnp += took;
  record.ms.pose += took;
  if (!initial) return false;
  std::vector<Match> agreeing;
  for (const int i : initial->inliers) agreeing.push_back(matches[static_cast<std::size_t>(i)]);
  frame.camera_from_world = initial->camera_from_world;
  frame.start_agreed = false;
  const PoseRefinement refined = refine(map, frame, agreeing, 0.0, record);
  if (refined.inliers < kMinModelInliers) return false;
  frame.camera_from_world = refined.camera_from_world;
  std::fill(frame.points.begin(), frame.points.end(), kNone);
  for (std::size_t i = 0; i < agreeing.size(); ++i)
    if (refined.inlier[i]) frame.points[static_cast<std::size_t>(agreeing[i].feature)] = agreeing[i].point;
  record.pose_start = PoseStart::epnp;
  return true;
}

/// Those found already, then those that only the local map tells of.
std::vector<Match> Tracker::match_local_map(const LocalMap& map, TrackedFrame& frame) const {
  std::vector<Match> matches;
  std::vector<int> matched;
  matches.reserve(frame.points.size());
  matched.reserve(frame.points.size());
  for (std::size_t f = 0; f < frame.points.size(); ++f)
    if (frame.points[f] != kNone) {
      matches.push_back({static_cast<int>(f), frame.points[f], 0, 0});
      matched.push_back(frame.points[f]);
    }
  std::sort(matched.begin(), matched.end());

  const std::vector<int> local = local_points(map, frame);
  std::vector<Candidate> candidates;
  candidates.reserve(local.size());
  frame.points_in_view.reserve(local.size());
  frame.points_found.reserve(frame.points.size());
  for (const int id : local) {
    const MapPoint& point = map.point(id);
    if (std::binary_search(matched.begin(), matched.end(), id)) {
      frame.points_in_view.push_back(id);
      continue;
    }
    const Projection seen = project_point(point, camera_, frame.camera_from_world, config_.features);
    if (!seen.visible) continue;
    frame.points_in_view.push_back(id);
    const double radius = config_.tracking.map_radius_px * scales_[static_cast<std::size_t>(seen.octave)];
    candidates.push_back({id, seen.pixel, static_cast<float>(radius), seen.octave - 1, seen.octave + 1,
                          &point.descriptor, -1.0F});
  }
  for (const Match& match : match_in_windows(*frame.features, candidates, config_.tracking.match_max_distance,
                                             config_.tracking.match_ratio))
    if (frame.points[static_cast<std::size_t>(match.feature)] == kNone) matches.push_back(match);
  return matches;
}

PoseRefinement Tracker::refine_by_local_map(const LocalMap& map, TrackedFrame& frame,
                                            FrameRecord& record) const {
  const Stopwatch watch;
  const std::vector<Match> matches = match_local_map(map, frame);
  record.ms.matching += watch.milliseconds();

  const PoseRefinement refined = refine(map, frame, matches, start_gate(frame), record);
  frame.camera_from_world = refined.camera_from_world;
  record.matches = static_cast<int>(matches.size());
  record.inliers = refined.inliers;
  record.rms_px = refined.rms_px;
  record.pose_covariance = refined.covariance();
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const auto f = static_cast<std::size_t>(matches[i].feature);
    frame.points[f] = refined.inlier[i] ? matches[i].point : kNone;
    if (refined.inlier[i]) frame.points_found.push_back(matches[i].point);
    FeatureRecord& feature = frame.records[static_cast<std::size_t>(frame.record_of[f])];
    feature.map_point = matches[i].point;
    feature.residual_px = refined.residual_px[i];
    feature.fate = refined.inlier[i] ? FeatureFate::inlier : FeatureFate::outlier;
  }
  return refined;
}

PoseRefinement Tracker::search_again(const LocalMap& map, const Pose& camera_from_world, TrackedFrame& frame,
                                     FrameRecord& record) const {
  frame.camera_from_world = camera_from_world;
  frame.start_agreed = false;
  frame.points.assign(frame.points.size(), kNone);
  frame.points_in_view.clear();
  frame.points_found.clear();
  for (const int i : frame.record_of) {
    FeatureRecord& feature = frame.records[static_cast<std::size_t>(i)];
    feature.fate = FeatureFate::unmatched;
    feature.map_point = kNone;
    feature.residual_px = 0.0F;
  }
  return refine_by_local_map(map, frame, record);
}

std::vector<PoseObservation> Tracker::observations_of(const LocalMap& map, const TrackedFrame& frame,
                                                      const std::vector<Match>& matches) const {
  std::vector<PoseObservation> observations;
  observations.reserve(matches.size());
  const FeatureSet& features = *frame.features;
  for (const Match& match : matches) {
    const auto f = static_cast<std::size_t>(match.feature);
    const cv::Point2f pixel = features.undistorted[f];
    observations.push_back({map.point(match.point).position,
                            {pixel.x, pixel.y},
                            features.depth[f],
                            scales_[static_cast<std::size_t>(features.keypoints[f].octave)],
                            features.static_weight[f]});
  }
  return observations;
}

PoseRefinement Tracker::refine(const LocalMap& map, const TrackedFrame& frame,
                               const std::vector<Match>& matches, double start_gate,
                               FrameRecord& record) const {
  const Stopwatch watch;
  PoseRefinement refined = refine_pose(camera_, observations_of(map, frame, matches), frame.camera_from_world,
                                       config_.tracking, start_gate);
  record.refine_iterations += refined.iterations;
  const double took = watch.milliseconds();
  record.ms.refine += took;
  record.ms.pose += took;
  return refined;
}

double Tracker::start_gate(const TrackedFrame& frame) const {
  return frame.start_agreed ? config_.tracking.start_gate : 0.0;
}

std::vector<int> Tracker::local_points(const LocalMap& map, const TrackedFrame& frame) const {
  return stillpoint::local_points(map, frame.points, path_.last().reference_keyframe,
                                  config_.map.max_local_keyframes);
}

}  // namespace stillpoint
