#include "core/odometry/motion_replay.hpp"

#include "core/motion/segments.hpp"

namespace stillpoint {

MotionReplay::MotionReplay(const Camera& camera, const Config& config) : odometry_(camera, config) {
  odometry_.last_ = Odometry::Last{};  // without points: none is to be purged
}

void MotionReplay::make_view(const Frame& frame) {
  odometry_.view_.reset();
  if (!frame.has_depth()) return;
  const DepthMotionConfig& config = odometry_.config_.depth_motion;
  odometry_.view_ = std::make_shared<const RgbdView>(
      make_rgbd_view(frame.gray, frame.depth, odometry_.camera_, config.factor));
}

void MotionReplay::take(const Frame& frame, const FrameRecord& record, const cv::Mat& log_odds) {
  FrameResult result;
  result.record.index = record.index;
  result.record.estimated = record.estimated;
  result.record.world_from_camera = record.world_from_camera;
  result.depth_motion.log_odds = log_odds;
  make_view(frame);
  odometry_.remember_view(frame, result);
}

FrameResult MotionReplay::repeat(const Frame& frame, const FrameRecord& record) {
  FrameResult result;
  result.record.index = record.index;
  result.record.estimated = record.estimated;
  result.record.world_from_camera = record.world_from_camera;
  make_view(frame);
  if (record.prior_pose) result.mask = odometry_.remembered_mask(frame, *record.prior_pose, result.record);
  if (record.motion_pose && odometry_.view_)
    odometry_.patches_ = segment_surfaces(*odometry_.view_, odometry_.config_.depth_motion);
  if (record.motion_pose) odometry_.detect_by_pose(frame, *record.motion_pose, result);
  // The run found that too little was left without what moves, removed nothing and forgot it.
  if (as_the_run_ && record.mask_share == 0.0 && result.record.mask_share > 0.0) {
    result.mask.release();
    result.depth_motion.log_odds.setTo(0);
    result.record.mask_share = 0.0;
  }
  odometry_.remember_view(frame, result);
  return result;
}

std::optional<MotionReplay> MotionReplay::continued_with(const Config& config,
                                                         const std::vector<PastFrame>& before) const {
  std::optional<Odometry> odometry = odometry_.continued_with(config, before);
  if (!odometry) return std::nullopt;
  MotionReplay other = *this;
  other.odometry_ = std::move(*odometry);
  other.as_the_run_ = false;
  return other;
}

}  // namespace stillpoint
