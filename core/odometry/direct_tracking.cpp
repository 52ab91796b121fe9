// Tracking without corners: the part of Odometry that aligns a frame directly where matches starve.
#include <algorithm>
#include <cmath>

#include "core/odometry/odometry.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

constexpr int kMinFusedInliers = 10;  // fewer matches have no say beside the patches

/// What two estimates of a pose that do not know of each other say together, each by its information: one
/// step from one towards the other. @param share of the second in it, 0 to 1
Pose fused(const Pose& one, const Matrix6d& one_information, const Pose& other,
           const Matrix6d& other_information, double& share) {
  Matrix6d both = one_information + other_information;
  both.diagonal().array() += 1e-9;
  const Matrix6d part = both.ldlt().solve(other_information);
  share = part.trace() / 6.0;
  return se3_exp(Vector6d(part * se3_log(other * one.inverse()))) * one;
}

}  // namespace

bool Odometry::aligns_directly() const {
  return config_.direct.below_inliers > 0 && motion_.info().extends_odometry;
}

bool Odometry::starves(int inliers) const {
  return aligns_directly() && inliers < std::max<double>(config_.direct.below_inliers,
                                                         config_.direct.below_share * usual_inliers_);
}

void Odometry::remember_reference(const Frame& frame, const FrameResult& result) {
  const FrameRecord& record = result.record;
  if (!record.estimated || !frame.has_depth()) return;
  DirectReference reference;
  reference.frame_index = frame.index;
  reference.gray = frame.gray;
  reference.depth = frame.depth;
  reference.lag = depth_lag(frame);
  reference.velocity = velocity_;
  reference.moving = small_mask(result.mask);
  reference.reference_keyframe = record.reference_keyframe;
  reference.camera_from_keyframe = record.camera_from_reference;
  if (record.status == FrameStatus::initialised || !starves(record.inliers)) sharp_reference_ = reference;
  last_reference_ = std::move(reference);
}

std::optional<Odometry::DirectPose> Odometry::align(const Frame& frame, const Current& current,
                                                    FrameRecord& record) const {
  const Stopwatch watch;
  std::optional<DirectPose> result;
  int tried = kNone;
  const cv::Mat moving = small_mask(current.mask);
  const Pose last_from_world = last_camera_from_world();
  for (const auto* reference : {&sharp_reference_, &last_reference_}) {
    if (!*reference || frame.index - (*reference)->frame_index > config_.direct.max_age) continue;
    if ((*reference)->frame_index == tried) continue;
    const Pose world_from_reference =
        ((*reference)->camera_from_keyframe * map_.pose_of((*reference)->reference_keyframe)).inverse();
    DirectTarget target{frame.gray, frame.depth, moving, {}};
    if (camera_.readout_s != 0.0 && config_.tracking.correct_rolling_shutter)
      target.velocity = [&](const Pose& target_from_reference) -> Vector6d {
        return se3_log(target_from_reference * world_from_reference.inverse() * last_from_world.inverse()) /
               elapsed();
      };
    const DirectAlignment aligned =
        align_directly(**reference, target,
                       {current.camera_from_world * world_from_reference,
                        current.start * world_from_reference, last_from_world * world_from_reference},
                       camera_, config_);
    record.direct = aligned.record;
    record.direct.reference_frame = tried = (*reference)->frame_index;
    if (!aligned.record.believed) continue;
    result = {aligned.target_from_reference * world_from_reference.inverse(), aligned.information};
    break;
  }
  const double took = watch.milliseconds();
  record.ms.direct += took;
  record.ms.pose += took;
  return result;
}

bool Odometry::begins_starved(const Current& current) {
  const auto found = static_cast<double>(
      std::count_if(current.points.begin(), current.points.end(), [](int point) { return point != kNone; }));
  constexpr double kHardly = 0.6;  // the first pose is but a first one: it may do with fewer
  const bool starved = found < kHardly * config_.direct.below_share * usual_first_inliers_;
  // Before what moves has had time to be found, patches on it would take the camera along: consensus does
  // not.
  usual_first_inliers_ = std::max(kUsualFades * usual_first_inliers_, found);
  return starved && motion_.settled();
}

double Odometry::noise_of_corners(const Current& current, const Pose& camera_from_world) const {
  double squares = 0.0;
  int count = 0;
  for (std::size_t f = 0; f < current.points.size(); ++f) {
    if (current.points[f] == kNone) continue;
    const Eigen::Vector3d p = camera_from_world * map_.point(current.points[f]).position;
    if (p.z() < 0.05) continue;
    const cv::Point2f pixel = current.features->undistorted[f];
    const double sigma = scales_[static_cast<std::size_t>(current.features->keypoints[f].octave)];
    squares += (camera_.project(p) - Eigen::Vector2d(pixel.x, pixel.y)).squaredNorm() / (2.0 * sigma * sigma);
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : 0.0;
}

bool Odometry::begin_directly(const Frame& frame, Current& current, FrameRecord& record) const {
  const auto aligned = align(frame, current, record);
  if (!aligned) return false;
  current.camera_from_world = aligned->camera_from_world;
  current.agreed = false;
  return true;
}

PoseRefinement Odometry::search_again(Current& current, const Pose& camera_from_world,
                                      FrameRecord& record) const {
  current.camera_from_world = camera_from_world;
  current.start_agreed = false;
  current.points.assign(current.points.size(), kNone);
  current.points_in_view.clear();
  current.points_found.clear();
  for (const int i : current.record_of) {
    FeatureRecord& feature = current.records[static_cast<std::size_t>(i)];
    feature.fate = FeatureFate::unmatched;
    feature.map_point = kNone;
    feature.residual_px = 0.0F;
  }
  return track_local_map(current, record);
}

bool Odometry::refine_directly(const Frame& frame, Current& current, PoseRefinement& refined,
                               FrameRecord& record) const {
  // Where nearly all matches agree nothing is smeared: they are few because the view is a new one, for which
  // a keyframe is the remedy.
  constexpr double kSharp = 0.85;
  if (refined.inliers >= std::max(inliers_needed(), config_.direct.below_inliers) &&
      refined.inliers > kSharp * record.matches)
    return false;
  const auto aligned = align(frame, current, record);
  if (!aligned) return false;
  const Pose& directly = aligned->camera_from_world;
  const int needed = inliers_needed();
  if (refined.inliers < needed) {
    // Searched from where patches say the camera stands, corners may be found after all.
    record.pose_start = PoseStart::direct;
    refined = search_again(current, directly, record);
  }
  if (refined.inliers >= kMinFusedInliers) {
    // Blur smears corners to one side or the other, all of them alike: they agree with each other, and not
    // with the patches. As far off as they lie under the patches' pose, so little they weigh.
    const double noise = std::max(1.0, noise_of_corners(current, directly));
    current.camera_from_world =
        fused(refined.camera_from_world, Matrix6d(refined.information / (noise * noise)), directly,
              aligned->information, record.direct.share);
  } else {
    current.camera_from_world = directly;
    record.direct.share = 1.0;
  }
  return true;
}

bool Odometry::is_starved_keyframe(const Frame& frame, const Current& current) const {
  constexpr int kLong = 5;        // frames: by then the view is another one, and the map knows nothing of it
  constexpr int kFeatures = 100;  // with depth: fewer make no keyframe to track against
  if (starved_frames_ < kLong || !frame.has_depth() || pending_) return false;
  if (map_.observers(current.points).empty()) return false;  // nothing would tie it to the map
  const auto& depth = current.features->depth;
  return std::count_if(depth.begin(), depth.end(), [](float z) { return z > 0; }) >= kFeatures;
}

void Odometry::remember_pose(const Current& current, FrameRecord& record) {
  if (!map_.has_keyframe(last_->reference_keyframe))
    last_->reference_keyframe = map_.keyframes().rbegin()->first;
  last_->camera_from_reference =
      current.camera_from_world * map_.keyframe(last_->reference_keyframe).camera_from_world.inverse();
  record.reference_keyframe = last_->reference_keyframe;
  record.camera_from_reference = last_->camera_from_reference;
  record.world_from_camera = current.camera_from_world.inverse();
  last_timestamp_ = now_;
}

}  // namespace stillpoint
