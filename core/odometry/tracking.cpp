// Finding the pose of one frame: the part of Odometry between removal and the map's upkeep.
#include <algorithm>

#include "core/odometry/consensus.hpp"
#include "core/odometry/odometry.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

constexpr int kConsensusSamples = 200;
constexpr int kMinModelInliers = 10;  // matches that must agree before the motion model's pose is believed

}  // namespace

std::vector<PoseObservation> Odometry::observations_of(const Current& current,
                                                       const std::vector<Match>& matches) const {
  std::vector<PoseObservation> observations;
  observations.reserve(matches.size());
  for (const Match& match : matches) {
    const auto f = static_cast<std::size_t>(match.feature);
    const cv::Point2f pixel = current.features->undistorted[f];
    observations.push_back({map_.point(match.point).position,
                            {pixel.x, pixel.y},
                            current.features->depth[f],
                            scales_[static_cast<std::size_t>(current.features->keypoints[f].octave)],
                            current.features->trust[f]});
  }
  return observations;
}

PoseRefinement Odometry::refine(const Current& current, const std::vector<Match>& matches,
                                double start_looseness, FrameRecord& record) const {
  const Stopwatch watch;
  PoseRefinement refined = refine_pose(camera_, observations_of(current, matches), current.camera_from_world,
                                       config_.tracking, start_looseness);
  record.refine_iterations += refined.iterations;
  const double took = watch.milliseconds();
  record.ms.refine += took;
  record.ms.pose += took;
  return refined;
}

bool Odometry::estimate_from_last(Current& current, FrameRecord& record) const {
  const TrackingConfig& tracking = config_.tracking;
  const Pose predicted = current.camera_from_world;
  for (const double radius : {tracking.search_radius_px, tracking.search_radius_wide_px}) {
    Stopwatch watch;
    std::vector<Candidate> candidates;
    candidates.reserve(last_->points.size());
    for (std::size_t i = 0; i < last_->points.size(); ++i) {
      const int id = last_->points[i];
      if (id == kNone || !map_.has_point(id)) continue;
      const MapPoint& point = map_.point(id);
      const Eigen::Vector3d p = predicted * point.position;
      if (p.z() < 0.05) continue;
      const Eigen::Vector2d pixel = camera_.project(p);
      if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() >= camera_.width || pixel.y() >= camera_.height)
        continue;
      const cv::KeyPoint& seen = last_->features->keypoints[i];
      candidates.push_back({id,
                            {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())},
                            static_cast<float>(radius * scales_[static_cast<std::size_t>(seen.octave)]),
                            seen.octave - 1,
                            seen.octave + 1,
                            &last_->features->descriptors[i],
                            seen.angle});
    }
    const std::vector<Match> matches = consistently_turned(
        match_in_windows(*current.features, candidates, tracking.match_max_distance, 1.0));
    record.ms.matching += watch.lap();
    record.matches = static_cast<int>(matches.size());
    if (record.matches < tracking.min_initial_matches) continue;

    current.camera_from_world = predicted;
    PoseRefinement refined =
        refine(current, matches, current.start_agreed ? tracking.start_looseness : 0.0, record);
    if (refined.inliers < kMinModelInliers) continue;
    if (current.seek_consensus) {
      watch.lap();
      const Consensus agreed =
          consensus_pose(camera_, observations_of(current, matches), {predicted, refined.camera_from_world},
                         kConsensusSamples, current.seed);
      refined.camera_from_world = agreed.camera_from_world;
      refined.inlier = agreed.inlier;
      // Where blur moves most corners, few agree, and beside the truth.
      current.agreed = 2 * agreed.inliers >= static_cast<int>(matches.size());
      const double took = watch.milliseconds();
      record.ms.consensus += took;
      record.ms.pose += took;
    }
    current.camera_from_world = refined.camera_from_world;
    for (std::size_t i = 0; i < matches.size(); ++i)
      if (refined.inlier[i]) current.points[static_cast<std::size_t>(matches[i].feature)] = matches[i].point;
    record.pose_start =
        radius == tracking.search_radius_px ? PoseStart::motion_model : PoseStart::wide_search;
    return true;
  }
  current.camera_from_world = predicted;
  return false;
}

bool Odometry::estimate_by_epnp(Current& current, FrameRecord& record) const {
  constexpr int kMaxDistance = 60;  // bits: without a window only close descriptors tell points apart
  constexpr double kRatio = 0.8;
  Stopwatch watch;
  std::vector<Candidate> candidates;
  for (const int id : local_points(current.points)) {
    Candidate candidate;
    candidate.point = id;
    candidate.descriptor = &map_.point(id).descriptor;
    candidates.push_back(candidate);
  }
  const std::vector<Match> matches = match_everywhere(*current.features, candidates, kMaxDistance, kRatio);
  record.ms.matching += watch.lap();
  record.matches = static_cast<int>(matches.size());

  const auto initial = initial_pose(camera_, observations_of(current, matches), config_.tracking);
  const double took = watch.milliseconds();
  record.ms.epnp += took;
  record.ms.pose += took;
  if (!initial) return false;
  std::vector<Match> agreeing;
  for (const int i : initial->inliers) agreeing.push_back(matches[static_cast<std::size_t>(i)]);
  current.camera_from_world = initial->camera_from_world;
  current.start_agreed = false;
  const PoseRefinement refined = refine(current, agreeing, 0.0, record);
  if (refined.inliers < kMinModelInliers) return false;
  current.camera_from_world = refined.camera_from_world;
  std::fill(current.points.begin(), current.points.end(), kNone);
  for (std::size_t i = 0; i < agreeing.size(); ++i)
    if (refined.inlier[i]) current.points[static_cast<std::size_t>(agreeing[i].feature)] = agreeing[i].point;
  record.pose_start = PoseStart::epnp;
  return true;
}

std::vector<int> Odometry::local_points(const std::vector<int>& matched) const {
  std::vector<std::pair<int, int>> seeds = map_.observers(matched);
  if (seeds.empty()) {  // nothing matched yet: about where the camera was last
    const int reference = map_.has_keyframe(last_->reference_keyframe) ? last_->reference_keyframe
                                                                       : map_.keyframes().rbegin()->first;
    seeds = map_.covisible(reference);
    seeds.insert(seeds.begin(), {reference, 0});
  }
  const auto wanted = static_cast<std::size_t>(config_.map.max_local_keyframes);
  if (seeds.size() > wanted) seeds.resize(wanted);
  std::vector<int> keyframes;
  for (const auto& seed : seeds) keyframes.push_back(seed.first);
  // Room left goes to the neighbours of what the frame sees most of.
  for (std::size_t i = 0; i < seeds.size() && keyframes.size() < wanted; ++i)
    for (const auto& [neighbour, shared] : map_.covisible(seeds[i].first))
      if (keyframes.size() < wanted &&
          std::find(keyframes.begin(), keyframes.end(), neighbour) == keyframes.end())
        keyframes.push_back(neighbour);

  std::vector<const std::vector<int>*> seen;
  for (const int keyframe : keyframes) seen.push_back(&map_.keyframe(keyframe).points);
  return each_once(seen);
}

PoseRefinement Odometry::track_local_map(Current& current, FrameRecord& record) const {
  Stopwatch watch;
  std::vector<Match> matches;
  std::vector<int> matched;
  matches.reserve(current.points.size());
  matched.reserve(current.points.size());
  for (std::size_t f = 0; f < current.points.size(); ++f)
    if (current.points[f] != kNone) {
      matches.push_back({static_cast<int>(f), current.points[f], 0, 0});
      matched.push_back(current.points[f]);
    }
  std::sort(matched.begin(), matched.end());

  const std::vector<int> local = local_points(current.points);
  std::vector<Candidate> candidates;
  candidates.reserve(local.size());
  current.points_in_view.reserve(local.size());
  current.points_found.reserve(current.points.size());
  for (const int id : local) {
    const MapPoint& point = map_.point(id);
    if (std::binary_search(matched.begin(), matched.end(), id)) {
      current.points_in_view.push_back(id);
      continue;
    }
    const Projection seen = project_point(point, camera_, current.camera_from_world, config_.features);
    if (!seen.visible) continue;
    current.points_in_view.push_back(id);
    const double radius = config_.tracking.map_radius_px * scales_[static_cast<std::size_t>(seen.octave)];
    candidates.push_back({id, seen.pixel, static_cast<float>(radius), seen.octave - 1, seen.octave + 1,
                          &point.descriptor, -1.0F});
  }
  for (const Match& match : match_in_windows(
           *current.features, candidates, config_.tracking.match_max_distance, config_.tracking.match_ratio))
    if (current.points[static_cast<std::size_t>(match.feature)] == kNone) matches.push_back(match);
  record.ms.matching += watch.lap();

  const PoseRefinement refined =
      refine(current, matches, current.start_agreed ? config_.tracking.start_looseness : 0.0, record);
  current.camera_from_world = refined.camera_from_world;
  record.matches = static_cast<int>(matches.size());
  record.inliers = refined.inliers;
  record.rms_px = refined.rms_px;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const auto f = static_cast<std::size_t>(matches[i].feature);
    current.points[f] = refined.inlier[i] ? matches[i].point : kNone;
    if (refined.inlier[i]) current.points_found.push_back(matches[i].point);
    FeatureRecord& feature = current.records[static_cast<std::size_t>(current.record_of[f])];
    feature.map_point = matches[i].point;
    feature.residual_px = refined.residual_px[i];
    feature.fate = refined.inlier[i] ? FeatureFate::inlier : FeatureFate::outlier;
  }
  return refined;
}

void Odometry::count_sightings(const Current& current) {
  for (const int id : current.points_in_view) ++map_.point(id).visible;
  for (const int id : current.points_found) ++map_.point(id).found;
}

}  // namespace stillpoint
