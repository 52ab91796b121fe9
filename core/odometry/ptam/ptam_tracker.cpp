#include "core/odometry/ptam/ptam_tracker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/odometry/engines.hpp"

namespace stillpoint {
namespace {

constexpr double kNearest = 0.1;  // m: nearer, nothing is measured, and pixels run off to infinity
constexpr double kCoarseBound = 1.0, kFineBound = 16.0;  // px² of a level: Tukey's, late

/// So many of them, spread evenly over the list.
template <typename Thing>
std::vector<Thing> thinned(const std::vector<Thing>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<Thing> kept;
  for (std::size_t i = 0; i < most; ++i) kept.push_back(all[i * all.size() / most]);
  return kept;
}

}  // namespace

PtamTracker::PtamTracker(const Camera& camera, const Config& config)
    : rectifier_(camera), config_(config.of<PtamConfig>().for_camera(camera)) {}

bool PtamTracker::adopt(const Config& config) {
  config_ = config.of<PtamConfig>().for_camera(rectifier_.pinhole());
  return true;
}

std::shared_ptr<const TrackerPreparation> PtamTracker::prepare(const cv::Mat& gray, const cv::Mat&) const {
  return make_ptam_image(gray, config_);
}

/// Where the motion model has the camera: the decaying velocity, its turn by the small images.
Pose PtamTracker::start_of(const TrackerFrame& frame, const Pose& predicted, PtamTrace& trace) const {
  const auto& image = static_cast<const PtamImage&>(*frame.prepared);
  const Camera& camera = rectifier_.pinhole();
  trace.small_now = image.small;
  if (frame.start_estimated) return predicted;
  if (lost_ >= config_.lost_after) {
    // Begins anew from the keyframe whose small image is most alike.
    int nearest = views_.begin()->first;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [id, view] : views_) {
      const double difference = cv::norm(view.image->small, image.small, cv::NORM_L2SQR);
      if (difference < least) least = difference, nearest = id;
    }
    trace.relocalised = true;
    trace.small_before = views_.at(nearest).image->small;
    Pose turned = Pose::Identity();
    turned.linear() = turn_between(trace.small_before, image.small, camera).now_from_then;
    return turned * map_.pose_of(nearest);
  }
  Vector6d motion = velocity_;
  trace.small_before = last_small_;
  if (!last_small_.empty()) {
    const Eigen::Matrix3d turn = turn_between(last_small_, image.small, camera).now_from_then;
    trace.turn_deg = rotation_angle(turn) * 180.0 / 3.14159265358979;
    motion.tail<3>() = so3_log(turn);
    motion[0] = motion[1] = 0.0;  // the turn has them: seen so small, a shift and a turn are one
  }
  trace.speed = std::hypot(velocity_.head<3>().norm() / scene_depth_, velocity_.tail<3>().norm());
  return se3_exp(motion) * last_;
}

void PtamTracker::place(const Vector6d& velocity, const Pose& camera_from_world, PtamSeen& seen) const {
  const Camera& camera = rectifier_.pinhole();
  const Eigen::Vector3d p = camera_from_world * seen.world;
  const Eigen::Vector2d middle = camera.project(p);
  seen.expected = middle;
  if (camera.readout_s != 0.0) {
    const double after = camera.row_time(middle.y());
    const Eigen::Vector3d then = p + after * (velocity.head<3>() + velocity.tail<3>().cross(p));
    if (then.z() > kNearest) seen.expected = camera.project(then);
  }
  seen.rolled = seen.expected - middle;
}

std::vector<PtamSeen> PtamTracker::project_points(const TrackerFrame& frame, const Vector6d& velocity,
                                                  const Pose& camera_from_world) const {
  const Camera& camera = rectifier_.pinhole();
  std::map<int, Eigen::Matrix3d> turn_from_source;
  for (const auto& [id, view] : views_)
    turn_from_source[id] =
        camera_from_world.linear() * map_.keyframe(id).camera_from_world.linear().transpose();
  std::vector<PtamSeen> all;
  for (const auto& [id, point] : points_) {
    PtamSeen seen;
    seen.point = id;
    seen.world = map_.point(id).position;
    const Eigen::Vector3d p = camera_from_world * seen.world;
    if (p.z() < kNearest) continue;
    place(velocity, camera_from_world, seen);
    if (!(seen.expected.x() >= 4 && seen.expected.y() >= 4 && seen.expected.x() < camera.width - 5 &&
          seen.expected.y() < camera.height - 5))
      continue;
    seen.static_weight = static_cast<double>(frame.weight_at(
        static_cast<int>(std::lround(seen.expected.x())), static_cast<int>(std::lround(seen.expected.y()))));
    if (const auto known = frame.point_weight.find(id); known != frame.point_weight.end())
      seen.static_weight *= static_cast<double>(known->second);
    seen.removed = seen.static_weight <= 0.0;
    // The patch lies on a plane that faces its keyframe: a pixel sideways and down there, as this view has
    // them.
    const Eigen::Matrix3d& turn = turn_from_source.at(point.keyframe);
    const double side = point.depth * (1 << point.level);
    const double iz = 1.0 / p.z();
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << camera.fx * iz, 0, -camera.fx * p.x() * iz * iz, 0, camera.fy * iz,
        -camera.fy * p.y() * iz * iz;
    Eigen::Matrix2d warp;
    warp << by_point * turn.col(0) * (side / camera.fx), by_point * turn.col(1) * (side / camera.fy);
    const cv::Mat& source = views_.at(point.keyframe).image->levels[static_cast<std::size_t>(point.level)];
    seen.patch = warped_patch(source, point.at, warp);
    if (!seen.patch) continue;
    seen.level = seen.patch->level;
    all.push_back(std::move(seen));
  }
  return all;
}

void PtamTracker::search(const TrackerFrame& frame, const PtamImage& image, std::vector<PtamSeen*>& wanted,
                         double radius_px, int subpixel_steps, PtamTrace& trace) const {
  for (PtamSeen* seen : wanted) {
    if (seen->removed || seen->found) continue;
    if (!seen->searched) ++trace.searched[static_cast<std::size_t>(seen->level)];
    seen->searched = true;
    const auto found =
        search_patch(*seen->patch, image, seen->expected, radius_px, config_.patch_limit, subpixel_steps);
    if (!found) continue;
    if (frame.weight_at(
            std::clamp(static_cast<int>(std::lround(found->pixel.x())), 0, frame.gray.cols - 1),
            std::clamp(static_cast<int>(std::lround(found->pixel.y())), 0, frame.gray.rows - 1)) <= 0.0F)
      continue;
    seen->found = true;
    seen->found_at = found->pixel;
    ++trace.found[static_cast<std::size_t>(seen->level)];
  }
}

PtamPose PtamTracker::solve(std::vector<PtamSeen*>& found, const Pose& start,
                            double late_bound_squared) const {
  std::vector<PtamSight> sights;
  for (const PtamSeen* seen : found)
    sights.push_back({seen->world, seen->found_at - seen->rolled, seen->level, seen->static_weight});
  const PtamPose pose = solve_ptam_pose(sights, start, rectifier_.pinhole(), late_bound_squared, config_);
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i]->weight = sights[i].weight;
    found[i]->error_px = std::ldexp(std::sqrt(sights[i].squared_px), found[i]->level);
  }
  return pose;
}

TrackerResult PtamTracker::begin(const TrackerFrame& frame, FrameRecord& record) {
  TrackerResult result;
  if (frame.depth.empty()) {
    result.why_lost = "the frame has no depth to begin with";
    return result;
  }
  PtamTracker begun = *this;
  auto trace = std::make_shared<PtamTrace>(rectifier_);
  trace->begins = true;
  begun.add_keyframe(frame, Pose::Identity(), *trace);
  if (static_cast<int>(begun.points_.size()) < config_.min_found) {
    result.why_lost = fmt::format("the frame has {} corners with depth; a map begins with {}",
                                  begun.points_.size(), config_.min_found);
    return result;
  }
  *this = std::move(begun);
  last_small_ = static_cast<const PtamImage&>(*frame.prepared).small;
  record.new_points = static_cast<int>(points_.size());
  result.trace = std::move(trace);
  return result;
}

TrackerResult PtamTracker::track(const TrackerFrame& frame, const Pose& predicted) const {
  TrackerResult result;
  const auto& image = static_cast<const PtamImage&>(*frame.prepared);
  auto trace = std::make_shared<PtamTrace>(rectifier_);
  Pose pose = start_of(frame, predicted, *trace);
  Vector6d velocity = frame.velocity_to ? frame.velocity_to(pose) : frame.velocity;
  trace->seen = project_points(frame, velocity, pose);

  // Coarse: a few large patches, far around.
  std::vector<PtamSeen*> large;
  for (int level = PtamConfig::kLevels - 1; level >= PtamConfig::kLevels - 2; --level)
    for (PtamSeen& seen : trace->seen)
      if (seen.level == level && !seen.removed) large.push_back(&seen);
  const bool far = trace->speed >= config_.coarse_speed || trace->relocalised || lost_ > 0;
  if (far && static_cast<int>(large.size()) > config_.coarse_least) {
    std::vector<PtamSeen*> few = thinned(large, static_cast<std::size_t>(config_.coarse_points));
    search(frame, image, few, config_.coarse_radius_px, config_.subpixel_steps, *trace);
    std::vector<PtamSeen*> found;
    for (PtamSeen* seen : few)
      if (seen->found) seen->coarse = true, found.push_back(seen);
    if (static_cast<int>(found.size()) >= config_.coarse_least) {
      trace->coarse = true;
      pose = solve(found, pose, kCoarseBound).camera_from_world;
    }
  }

  // Fine: many patches, large ones first, near around where the pose has them by now.
  if (frame.velocity_to) velocity = frame.velocity_to(pose);
  std::vector<PtamSeen*> many;
  for (int level = PtamConfig::kLevels - 1; level >= 0; --level) {
    std::vector<PtamSeen*> of_level;
    for (PtamSeen& seen : trace->seen)
      if (seen.level == level && !seen.removed) of_level.push_back(&seen);
    const std::size_t room = static_cast<std::size_t>(config_.fine_points) -
                             std::min(many.size(), static_cast<std::size_t>(config_.fine_points));
    const auto kept = thinned(of_level, room);
    many.insert(many.end(), kept.begin(), kept.end());
  }
  for (PtamSeen& seen : trace->seen) place(velocity, pose, seen);
  search(frame, image, many, trace->coarse ? config_.fine_radius_after_coarse_px : config_.fine_radius_px,
         config_.fine_subpixel_steps, *trace);
  std::vector<PtamSeen*> found;
  for (PtamSeen& seen : trace->seen)
    if (seen.found) found.push_back(&seen);
  trace->pose = solve(found, pose, kFineBound);
  if (frame.velocity_to && rectifier_.pinhole().readout_s != 0.0) {
    // How the rows bend is known only by how fast the camera went in this very frame.
    velocity = frame.velocity_to(trace->pose.camera_from_world);
    for (PtamSeen* seen : found) place(velocity, trace->pose.camera_from_world, *seen);
    trace->pose = solve(found, trace->pose.camera_from_world, kFineBound);
  }
  judge_quality(*trace);

  double squares = 0.0;
  for (const PtamSeen* seen : found) {
    if (seen->weight <= 0.0) continue;
    ++result.inliers;
    squares += seen->error_px * seen->error_px;
  }
  trace->rms_px = result.inliers > 0 ? std::sqrt(squares / result.inliers) : 0.0;
  result.matches = static_cast<int>(found.size());
  result.camera_from_world = trace->pose.camera_from_world;
  result.rms_px = trace->rms_px;
  result.iterations = trace->pose.iterations;
  result.start = trace->relocalised || trace->coarse ? PoseStart::wide_search : PoseStart::motion_model;
  if (result.inliers < config_.min_found)
    result.why_lost =
        fmt::format("{} points are found and agree; {} must", result.inliers, config_.min_found);
  else if (trace->quality == PtamQuality::kBad)
    result.why_lost = fmt::format("quality is bad: of large patches less than {:.0f} % are found",
                                  100.0 * config_.quality_bad);
  result.features = records_of(frame, *trace);
  int searched = 0, of_found = 0;
  for (std::size_t level = 0; level < trace->searched.size(); ++level)
    searched += trace->searched[level], of_found += trace->found[level];
  result.figures = {static_cast<double>(searched),
                    searched > 0 ? static_cast<double>(of_found) / searched : 0.0,
                    static_cast<double>(static_cast<int>(trace->quality)), trace->coarse ? 1.0 : 0.0,
                    static_cast<double>(points_.size())};
  result.trace = std::move(trace);
  return result;
}

void PtamTracker::judge_quality(PtamTrace& trace) const {
  int searched = 0, found = 0, large_searched = 0, large_found = 0;
  for (std::size_t level = 0; level < trace.searched.size(); ++level) {
    searched += trace.searched[level], found += trace.found[level];
    if (level < 2) continue;
    large_searched += trace.searched[level], large_found += trace.found[level];
  }
  const double share = searched > 0 ? static_cast<double>(found) / searched : 0.0;
  const double large = large_searched > 10 ? static_cast<double>(large_found) / large_searched : share;
  trace.quality = share > config_.quality_good  ? PtamQuality::kGood
                  : large < config_.quality_bad ? PtamQuality::kBad
                                                : PtamQuality::kDodgy;
}

std::vector<FeatureRecord> PtamTracker::records_of(const TrackerFrame& frame, const PtamTrace& trace) const {
  std::vector<FeatureRecord> features;
  for (const PtamSeen& seen : trace.seen) {
    if (!seen.searched && !seen.removed) continue;
    const Eigen::Vector2d& at = seen.found ? seen.found_at : seen.expected;
    const int x = static_cast<int>(std::lround(at.x())), y = static_cast<int>(std::lround(at.y()));
    FeatureRecord feature;
    feature.pixel = rectifier_.to_image(cv::Point2f(static_cast<float>(at.x()), static_cast<float>(at.y())));
    if (x < 0 || y < 0 || x >= frame.gray.cols || y >= frame.gray.rows || feature.pixel.x < 0 ||
        feature.pixel.y < 0 || feature.pixel.x > static_cast<float>(frame.gray.cols - 1) ||
        feature.pixel.y > static_cast<float>(frame.gray.rows - 1))
      continue;
    if (!frame.depth.empty()) feature.depth = frame.depth.at<float>(y, x);
    feature.octave = static_cast<std::uint8_t>(seen.level);
    feature.static_weight = static_cast<float>(seen.static_weight);
    feature.residual_px = static_cast<float>(seen.error_px);
    feature.fate = seen.removed        ? FeatureFate::removed
                   : !seen.found       ? FeatureFate::unmatched
                   : seen.weight > 0.0 ? FeatureFate::inlier
                                       : FeatureFate::outlier;
    if (seen.found) feature.map_point = seen.point;
    features.push_back(feature);
  }
  return features;
}

void PtamTracker::keep(const TrackerFrame& frame, TrackerResult& result, FrameRecord& record) {
  auto& trace = static_cast<PtamTrace&>(*result.trace);
  const Vector6d motion = se3_log(result.camera_from_world * last_.inverse());
  velocity_ = lost_ > 0 ? Vector6d(Vector6d::Zero())
                        : Vector6d(config_.velocity_decay * (0.5 * motion + 0.5 * velocity_));
  lost_ = 0;
  double depth = 0.0;
  int count = 0;
  for (const PtamSeen& seen : trace.seen)
    if (seen.found && seen.weight > 0.0) depth += (result.camera_from_world * seen.world).z(), ++count;
  if (count > 0) scene_depth_ = depth / count;
  vote(trace);
  cull_dynamic(frame, result.camera_from_world, trace);
  if (wants_keyframe(frame, result.camera_from_world, trace)) {
    add_keyframe(frame, result.camera_from_world, trace);
    const int keyframe = map_.keyframes().rbegin()->first;
    adjust(keyframe, trace);
    result.camera_from_world = map_.keyframe(keyframe).camera_from_world;
    record.keyframe = true;
    for (const int made : trace.made) record.new_points += made;
    if (trace.bundle) {
      record.bundle_iterations = trace.bundle->iterations;
      record.bundle_rms_before_px = trace.bundle->rms_before_px;
      record.bundle_rms_px = trace.bundle->rms_after_px;
    }
  }
  record.culled_points = trace.dropped;
  last_ = result.camera_from_world;
  last_small_ = static_cast<const PtamImage&>(*frame.prepared).small;
}

void PtamTracker::lose(const TrackerFrame& frame, const TrackerResult&) {
  ++lost_;
  velocity_.setZero();
  last_small_ = static_cast<const PtamImage&>(*frame.prepared).small;
}

/// Points that are found and do not agree, time after time, leave the map.
void PtamTracker::vote(PtamTrace& trace) {
  for (const PtamSeen& seen : trace.seen) {
    if (!seen.found) continue;
    const auto at = points_.find(seen.point);
    if (at == points_.end()) continue;
    ++(seen.weight > 0.0 ? at->second.inlier_votes : at->second.outlier_votes);
    if (at->second.outlier_votes <= config_.outlier_votes ||
        at->second.outlier_votes <= at->second.inlier_votes)
      continue;
    drop_point(seen.point);
    ++trace.dropped;
  }
}

void PtamTracker::cull_dynamic(const TrackerFrame& frame, const Pose& camera_from_world, PtamTrace& trace) {
  for (const PtamSeen& seen : trace.seen) {
    if (!seen.removed || !points_.contains(seen.point)) continue;
    if (!frame.is_dynamic(seen.expected, (camera_from_world * seen.world).z())) continue;
    drop_point(seen.point, true);
    ++trace.dropped;
  }
}

bool PtamTracker::wants_keyframe(const TrackerFrame& frame, const Pose& camera_from_world,
                                 PtamTrace& trace) const {
  const Eigen::Vector3d here = camera_from_world.inverse().translation();
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [id, view] : views_)
    nearest = std::min(nearest, (map_.keyframe(id).camera_from_world.inverse().translation() - here).norm());
  trace.decided = true;
  trace.keyframe_distance = nearest / scene_depth_;
  trace.keyframe_limit = config_.keyframe_distance_m / views_.begin()->second.mean_depth;
  trace.frames_since = frame.image.index - last_keyframe_frame_;
  return trace.quality == PtamQuality::kGood && trace.frames_since > config_.keyframe_gap &&
         trace.keyframe_distance > trace.keyframe_limit && !frame.depth.empty();
}

}  // namespace stillpoint
