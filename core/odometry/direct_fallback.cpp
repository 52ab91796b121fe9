#include "core/odometry/direct_fallback.hpp"

#include <algorithm>
#include <cmath>

#include "core/motion/methods.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

constexpr double kUsualFades = 0.98;  // a frame, of how many are usual
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

DirectFallback::DirectFallback(const Camera& camera, const Config& config) : camera_(camera) {
  adopt(config);
}

void DirectFallback::adopt(const Config& config) {
  config_ = config;
  enabled_ = config.direct.below_inliers > 0 && method_of(config).extends_odometry;
}

bool DirectFallback::starts_degraded(const TrackedFrame& frame) {
  const auto found = static_cast<double>(
      std::count_if(frame.points.begin(), frame.points.end(), [](int point) { return point != kNone; }));
  constexpr double kHardly = 0.6;  // the first pose is but a first one: it may do with fewer
  const bool starved = found < kHardly * config_.direct.below_share * usual_first_inliers_;
  usual_first_inliers_ = std::max(kUsualFades * usual_first_inliers_, found);
  return starved;
}

bool DirectFallback::is_degraded(int inliers) const {
  return enabled_ && inliers < std::max<double>(config_.direct.below_inliers,
                                                config_.direct.below_share * usual_inliers_);
}

std::optional<DirectFallback::DirectPose> DirectFallback::align(const Frame& image, const LocalMap& map,
                                                                const CameraPath& path,
                                                                const TrackedFrame& frame,
                                                                FrameRecord& record) const {
  const Stopwatch watch;
  std::optional<DirectPose> result;
  int tried = kNone;
  const cv::Mat moving = small_mask(frame.mask);
  const Pose last_from_world = path.last_camera_from_world(map);
  const double elapsed = path.elapsed(image.timestamp);
  for (const auto* reference : {&sharp_reference_, &last_reference_}) {
    if (!*reference || image.index - (*reference)->frame_index > config_.direct.max_age) continue;
    if ((*reference)->frame_index == tried) continue;
    const Pose world_from_reference =
        ((*reference)->camera_from_keyframe * map.pose_of((*reference)->reference_keyframe)).inverse();
    DirectTarget target{image.gray, image.depth, moving, {}};
    if (camera_.readout_s != 0.0 && config_.tracking.correct_rolling_shutter)
      target.velocity = [&](const Pose& target_from_reference) -> Vector6d {
        return se3_log(target_from_reference * world_from_reference.inverse() * last_from_world.inverse()) /
               elapsed;
      };
    const DirectAlignment aligned =
        align_directly(**reference, target,
                       {frame.camera_from_world * world_from_reference, frame.start * world_from_reference,
                        last_from_world * world_from_reference},
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

bool DirectFallback::begin(const Frame& image, const LocalMap& map, const CameraPath& path,
                           TrackedFrame& frame, FrameRecord& record) const {
  const auto aligned = align(image, map, path, frame, record);
  if (!aligned) return false;
  frame.camera_from_world = aligned->camera_from_world;
  frame.agreed = false;
  return true;
}

bool DirectFallback::refine(const Frame& image, const LocalMap& map, const Tracker& tracker,
                            TrackedFrame& frame, PoseRefinement& refined, FrameRecord& record) const {
  // Where nearly all matches agree nothing is smeared: they are few because the view is a new one, for which
  // a keyframe is the remedy.
  constexpr double kSharp = 0.85;
  const int needed = tracker.inliers_needed();
  if (refined.inliers >= std::max(needed, config_.direct.below_inliers) &&
      refined.inliers > kSharp * record.matches)
    return false;
  const auto aligned = align(image, map, tracker.path(), frame, record);
  if (!aligned) return false;
  const Pose& directly = aligned->camera_from_world;
  if (refined.inliers < needed) {
    // Searched from where patches say the camera stands, corners may be found after all.
    record.pose_start = PoseStart::direct;
    refined = tracker.search_again(map, directly, frame, record);
  }
  if (refined.inliers >= kMinFusedInliers) {
    // Blur smears corners to one side or the other, all of them alike: they agree with each other, and not
    // with the patches. As far off as they lie under the patches' pose, so little they weigh.
    const double noise = std::max(1.0, noise_of_corners(map, frame, tracker.scales(), directly));
    frame.camera_from_world =
        fused(refined.camera_from_world, Matrix6d(refined.information / (noise * noise)), directly,
              aligned->information, record.direct.share);
    refined.information = refined.information / (noise * noise) + aligned->information;
  } else {
    frame.camera_from_world = directly;
    record.direct.share = 1.0;
    refined.information = aligned->information;
  }
  refined.noise = 1.0;
  record.pose_covariance = refined.covariance();
  return true;
}

double DirectFallback::noise_of_corners(const LocalMap& map, const TrackedFrame& frame,
                                        const std::vector<double>& scales,
                                        const Pose& camera_from_world) const {
  double squares = 0.0;
  int count = 0;
  for (std::size_t f = 0; f < frame.points.size(); ++f) {
    if (frame.points[f] == kNone) continue;
    const Eigen::Vector3d p = camera_from_world * map.point(frame.points[f]).position;
    if (p.z() < 0.05) continue;
    const cv::Point2f pixel = frame.features->undistorted[f];
    const double sigma = scales[static_cast<std::size_t>(frame.features->keypoints[f].octave)];
    squares += (camera_.project(p) - Eigen::Vector2d(pixel.x, pixel.y)).squaredNorm() / (2.0 * sigma * sigma);
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : 0.0;
}

void DirectFallback::count(int inliers, bool directly) {
  degraded_frames_ = directly ? degraded_frames_ + 1 : 0;
  // Fading all the while: a view with fewer corners that lasts becomes the usual one.
  usual_inliers_ = std::max(kUsualFades * usual_inliers_, 1.0 * inliers);
}

bool DirectFallback::degraded_for_long() const {
  constexpr int kLong = 5;  // frames: by then the view is another one
  return degraded_frames_ >= kLong;
}

void DirectFallback::remember(const Frame& image, const FrameRecord& record, const cv::Mat& mask,
                              std::optional<double> lag, const Vector6d& velocity) {
  if (!enabled_ || !record.estimated || !image.has_depth()) return;
  DirectReference reference;
  reference.frame_index = image.index;
  reference.gray = image.gray;
  reference.depth = image.depth;
  reference.lag = lag;
  reference.velocity = velocity;
  reference.moving = small_mask(mask);
  reference.reference_keyframe = record.reference_keyframe;
  reference.camera_from_keyframe = record.camera_from_reference;
  if (record.status == FrameStatus::initialised || !is_degraded(record.inliers)) sharp_reference_ = reference;
  last_reference_ = std::move(reference);
}

void DirectFallback::drop_images() {
  for (auto* reference : {&last_reference_, &sharp_reference_})
    if (*reference) (*reference)->gray.release(), (*reference)->depth.release();
}

void DirectFallback::restore_images(int next, const std::function<Frame(int)>& read) {
  for (auto* reference : {&last_reference_, &sharp_reference_}) {
    // One that is too old for the next frame is never looked at again.
    if (!*reference || !(*reference)->gray.empty() ||
        next - (*reference)->frame_index > config_.direct.max_age)
      continue;
    const Frame frame = read((*reference)->frame_index);
    (*reference)->gray = frame.gray;
    (*reference)->depth = frame.depth;
  }
}

}  // namespace stillpoint
