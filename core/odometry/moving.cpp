// Method `stillpoint`'s part of Odometry: what is remembered to move, what moves under a first pose, and what
// the next frame is to know of it.
#include <algorithm>
#include <array>

#include "core/motion/depth_evidence.hpp"
#include "core/motion/regions.hpp"
#include "core/odometry/odometry.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {

namespace {

/// Whether any pixel moves by what is remembered: carried along, none moves more.
bool remembers_motion(const MotionMemory& memory, const DepthMotionConfig& config) {
  double most = 0.0;
  cv::minMaxLoc(memory.log_odds, nullptr, &most);
  return most > config.moving_log_odds;
}

}  // namespace

cv::Mat Odometry::remembered_mask(const Frame& frame, const Pose& predicted, FrameRecord& record) {
  const Stopwatch watch;
  record.prior_pose = predicted;
  cv::Mat mask;
  if (memory_ && !past_views_.empty() && remembers_motion(*memory_, config_.depth_motion)) {
    const Pose previous_from_current = past_views_.back().camera_from_world * predicted.inverse();
    const cv::Mat prior =
        carry_memory(*view_, *memory_, previous_from_current, config_.depth_motion).log_odds;
    mask = enlarged(prior > config_.depth_motion.moving_log_odds, view_->factor, frame.gray.size());
  }
  record.ms.motion += watch.milliseconds();
  return mask;
}

void Odometry::detect_in_colour(const Frame& frame, FrameResult& result) {
  if (frame.has_depth()) {
    colour_.reset();
    return;
  }
  const Stopwatch watch;
  if (!colour_) colour_.emplace(camera_, config_.colour_motion);
  result.colour_motion = colour_->next(frame.colour.empty() ? frame.gray : frame.colour, frame.timestamp);
  result.mask = result.colour_motion.mask;
  result.record.mask_share = result.colour_motion.mask_share;
  result.record.ms.motion += watch.milliseconds();
}

void Odometry::detect_by_pose(const Frame& frame, const Pose& camera_from_world, FrameResult& result) {
  if (!frame.has_depth()) return;
  const Stopwatch watch;
  result.record.motion_pose = camera_from_world;
  const Pose previous_from_current = past_views_.empty()
                                         ? Pose::Identity()
                                         : past_views_.back().camera_from_world * camera_from_world.inverse();
  result.depth_motion = detect_depth_motion(
      *view_, std::move(patches_), frame.depth, reference_views(frame.index, camera_from_world),
      memory_ ? &*memory_ : nullptr, previous_from_current, config_.depth_motion, config_.run.threads);
  result.mask = result.depth_motion.mask;
  result.record.mask_share = result.depth_motion.mask_share;
  purge_moving_points(frame, result.mask, camera_from_world);
  result.record.ms.motion += watch.milliseconds();
}

void Odometry::remember_view(const Frame& frame, const FrameResult& result) {
  if (!result.record.estimated || !frame.has_depth()) return;
  const cv::Mat& log_odds = result.depth_motion.log_odds;
  memory_ = MotionMemory{view_, log_odds.empty() ? cv::Mat::zeros(view_->depth.size(), CV_32FC1) : log_odds};
  past_views_.push_back({frame.index, view_, result.record.world_from_camera.inverse()});
  while (past_views_.size() > 1 &&
         past_views_[1].frame_index <= frame.index - farthest_reference(config_.depth_motion))
    past_views_.pop_front();
  view_.reset();
  patches_ = {};
}

std::vector<ReferenceView> Odometry::reference_views(int frame_index, const Pose& camera_from_world) const {
  std::vector<ReferenceView> references;
  const PastView* taken = nullptr;
  constexpr int kOld = 8;  // frames: from here on slow movers have gone somewhere
  for (const int gap : reference_gaps(config_.depth_motion, frame_index)) {
    // The youngest that is old enough, else the oldest there is.
    const auto it = std::find_if(past_views_.rbegin(), past_views_.rend(),
                                 [&](const PastView& past) { return past.frame_index <= frame_index - gap; });
    if (past_views_.empty()) break;
    const PastView& past = it != past_views_.rend() ? *it : past_views_.front();
    if (&past == taken) continue;
    taken = &past;
    const int back = frame_index - past.frame_index;
    references.push_back(
        {past.view, past.camera_from_world * camera_from_world.inverse(), back >= kOld, back});
  }
  return references;
}

bool Odometry::leaves_too_little(const Current& current) const {
  constexpr int kColumns = 8, kRows = 6;
  constexpr int kLeastParts = 5;  // of those 48 that features must lie in, or they tell no room from a mover
  if (current.record_of.size() == current.records.size()) return false;
  std::array<bool, kColumns * kRows> before{}, after{};
  for (const FeatureRecord& feature : current.records) {
    const int column =
        std::clamp(static_cast<int>(feature.pixel.x) * kColumns / camera_.width, 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>(feature.pixel.y) * kRows / camera_.height, 0, kRows - 1);
    const auto part = static_cast<std::size_t>(row * kColumns + column);
    before[part] = true;
    after[part] = after[part] || feature.fate != FeatureFate::removed;
  }
  const auto had = std::count(before.begin(), before.end(), true);
  const auto has = std::count(after.begin(), after.end(), true);
  return has < std::min<std::ptrdiff_t>(kLeastParts, had);
}

void Odometry::purge_moving_points(const Frame& frame, const cv::Mat& mask, const Pose& camera_from_world) {
  constexpr double kLikeDepth = 0.1;  // m: the point lies on what moves or before it, where nothing is now
  if (mask.empty() || config_.map.purge_moving == 0 || map_.keyframes().empty()) return;
  // Not only what the last frame showed: what has gone on meanwhile stays behind in the map.
  for (const int id : local_points()) {
    const Eigen::Vector3d p = camera_from_world * map_.point(id).position;
    if (p.z() < 0.05) continue;
    const Eigen::Vector2d pixel = camera_.distort(camera_.project(p));
    const int x = cvRound(pixel.x()), y = cvRound(pixel.y());
    if (x < 0 || y < 0 || x >= mask.cols || y >= mask.rows || mask.at<uchar>(y, x) == 0) continue;
    const float z = frame.depth.at<float>(y, x);
    if (z > 0 && p.z() < z + kLikeDepth) {
      map_.remove_moving_point(id);
    }
  }
}

}  // namespace stillpoint
