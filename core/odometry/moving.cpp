// Method `stillpoint`'s part of Odometry: a pose from what was still so far, what moves under that pose, and the pose
// again without it.
#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/motion/depth_evidence.hpp"
#include "core/motion/regions.hpp"
#include "core/odometry/odometry.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {

void Odometry::track_and_detect(const Frame& frame, const OrbFeatures& found, FrameResult& result) {
  FrameRecord& record = result.record;
  Stopwatch watch;
  const auto view = std::make_shared<const RgbdView>(
      make_rgbd_view(frame.gray, frame.depth, camera_, config_.depth_motion.factor));
  if (!last_) {
    Current current = remove_moving(frame, found, {}, record);
    initialise(frame, current, record);
    record.features = std::move(current.records);
  } else {
    const Pose predicted = predicted_camera_from_world();
    const cv::Mat remembered = remembered_mask(*view, predicted, frame.gray.size());
    record.ms.motion += watch.lap();
    Current first = remove_moving(frame, found, remembered, record);
    first.camera_from_world = predicted;
    first.seek_consensus = true;
    first.seed = static_cast<std::uint32_t>(config_.run.seed) + static_cast<std::uint32_t>(frame.index);
    const bool estimated = estimate(first, record);
    watch.lap();
    result.mask = remembered;
    if (estimated && frame.has_depth()) {
      const Pose previous_from_current =
          past_views_.empty() ? Pose::Identity() : past_views_.back().camera_from_world * first.camera_from_world.inverse();
      result.depth_motion = detect_depth_motion(*view, frame.depth, reference_views(frame.index, first.camera_from_world),
                                                memory_ ? &*memory_ : nullptr, previous_from_current, config_.depth_motion);
      result.mask = result.depth_motion.mask;
      record.mask_share = result.depth_motion.mask_share;
      purge_moving_points(frame, result.mask, first.camera_from_world);
    }
    record.ms.motion += watch.lap();
    Current current = remove_moving(frame, found, result.mask, record);
    current.camera_from_world = estimated ? first.camera_from_world : predicted;
    track(frame, current, record);
    record.features = std::move(current.records);
  }
  if (!record.estimated || !frame.has_depth()) return;
  memory_ = MotionMemory{view, result.depth_motion.log_odds.empty() ? cv::Mat::zeros(view->depth.size(), CV_32FC1)
                                                                    : result.depth_motion.log_odds};
  past_views_.push_back({frame.index, view, record.world_from_camera.inverse()});
  while (past_views_.size() > 1 && past_views_[1].frame_index <= frame.index - config_.depth_motion.far_reference)
    past_views_.pop_front();
}

cv::Mat Odometry::remembered_mask(const RgbdView& view, const Pose& predicted, const cv::Size& size) const {
  if (!memory_ || past_views_.empty()) return {};
  const Pose previous_from_current = past_views_.back().camera_from_world * predicted.inverse();
  const cv::Mat prior = carry_memory(view, *memory_, previous_from_current, config_.depth_motion);
  cv::Mat mask;
  cv::resize(prior > config_.depth_motion.moving_log_odds, mask, size, 0, 0, cv::INTER_NEAREST);
  return mask;
}

std::vector<ReferenceView> Odometry::reference_views(int frame_index, const Pose& camera_from_world) const {
  std::vector<ReferenceView> references;
  const PastView* taken = nullptr;
  for (const int gap : {config_.depth_motion.near_reference, config_.depth_motion.far_reference}) {
    // The youngest that is old enough, else the oldest there is.
    const auto it = std::find_if(past_views_.rbegin(), past_views_.rend(),
                                 [&](const PastView& past) { return past.frame_index <= frame_index - gap; });
    if (past_views_.empty()) break;
    const PastView& past = it != past_views_.rend() ? *it : past_views_.front();
    if (&past == taken) continue;
    taken = &past;
    references.push_back({past.view, past.camera_from_world * camera_from_world.inverse()});
  }
  return references;
}

void Odometry::purge_moving_points(const Frame& frame, const cv::Mat& mask, const Pose& camera_from_world) {
  constexpr double kLikeDepth = 0.1;  // m: the point lies on what moves, not behind it
  if (mask.empty()) return;
  for (int& id : last_->points) {
    if (id == kNone || !map_.has_point(id)) continue;
    const Eigen::Vector3d p = camera_from_world * map_.point(id).position;
    if (p.z() < 0.05) continue;
    const Eigen::Vector2d pixel = camera_.distort(camera_.project(p));
    const int x = cvRound(pixel.x()), y = cvRound(pixel.y());
    if (x < 0 || y < 0 || x >= mask.cols || y >= mask.rows || mask.at<uchar>(y, x) == 0) continue;
    const float z = frame.depth.at<float>(y, x);
    if (z > 0 && p.z() < z + kLikeDepth) {
      map_.remove_point(id);
      id = kNone;
    }
  }
}

}  // namespace stillpoint
