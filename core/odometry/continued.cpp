// Going on from the middle of a run: with another config, or from a copy that was put by.
#include "core/odometry/odometry.hpp"

namespace stillpoint {
namespace {

/// Whether views and memory made under `before` serve under `after`.
bool same_past_views(const Config& before, const Config& after) {
  return before.run.method == "stillpoint" && before.depth_motion.factor == after.depth_motion.factor &&
         farthest_reference(before.depth_motion) >= farthest_reference(after.depth_motion);
}

bool compares_by_homography(const Config& config) {
  return config.run.method != "none" && config.run.method != "oracle" && config.run.method != "stillpoint";
}

/// The same of prepared frames for the homography.
bool same_references(const Config& before, const Config& after) {
  return compares_by_homography(before) && compares_by_homography(after) && before.motion == after.motion;
}

std::deque<std::shared_ptr<const MotionFrame>> motion_frames(const std::vector<PastFrame>& before,
                                                             const Config& config) {
  std::deque<std::shared_ptr<const MotionFrame>> frames;
  if (!compares_by_homography(config)) return frames;
  for (const PastFrame& past : before) {
    if (!past.frame.readable()) continue;
    frames.push_back(
        std::make_shared<const MotionFrame>(prepare_motion_frame(past.frame.gray, config.motion)));
    if (static_cast<int>(frames.size()) > config.motion.reference_gap) frames.pop_front();
  }
  return frames;
}

}  // namespace

void Odometry::drop_images() {
  preparer_.forget();
  for (PastView& past : past_views_) past.view.reset();
  if (memory_) memory_->view.reset();
  for (auto* reference : {&last_reference_, &sharp_reference_})
    if (*reference) (*reference)->gray.release(), (*reference)->depth.release();
}

void Odometry::restore_images(int next, const std::function<Frame(int)>& read) {
  if (compares_by_homography(config_)) {
    std::deque<std::shared_ptr<const MotionFrame>> references;
    for (int i = next - 1; i >= 0 && static_cast<int>(references.size()) < config_.motion.reference_gap; --i)
      if (const Frame frame = read(i); frame.readable())
        references.push_front(
            std::make_shared<const MotionFrame>(prepare_motion_frame(frame.gray, config_.motion)));
    preparer_.forget();
    for (const auto& reference : references) preparer_.pass(reference);
  }
  for (PastView& past : past_views_) {
    if (past.view) continue;
    const Frame frame = read(past.frame_index);
    past.view = std::make_shared<const RgbdView>(
        make_rgbd_view(frame.gray, frame.depth, camera_, config_.depth_motion.factor));
  }
  if (memory_ && !memory_->view) memory_->view = past_views_.back().view;
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

int Odometry::frames_wanted(const Config& config) const {
  if (compares_by_homography(config))
    return same_references(config_, config) ? 0 : config.motion.reference_gap;
  const bool compares_views =
      config.run.method == "stillpoint" &&
      !(same_past_views(config_, config) && config.colour_motion == config_.colour_motion);
  return compares_views ? farthest_reference(config.depth_motion) : 0;
}

std::optional<Odometry> Odometry::continued_with(const Config& config,
                                                 const std::vector<PastFrame>& before) const {
  if (config.features.levels != config_.features.levels ||
      config.features.scale_factor != config_.features.scale_factor)
    return std::nullopt;
  Odometry next = *this;
  next.config_ = config;
  next.preparer_ = FramePreparer(camera_, config);
  if (!next.looks_back()) next.hindsight_.forget_pending();

  const bool keeps_references = same_references(config_, config);
  for (const auto& reference : keeps_references ? preparer_.references() : motion_frames(before, config))
    next.preparer_.pass(reference);

  if (config.run.method != config_.run.method || !(config.colour_motion == config_.colour_motion)) {
    next.colour_.reset();
    for (const PastFrame& past : before) {
      if (config.run.method != "stillpoint" || !past.frame.readable()) continue;
      FrameResult unused;
      next.detect_in_colour(past.frame, unused);
    }
  }
  if (config.run.method == "stillpoint" && same_past_views(config_, config)) return next;
  next.past_views_.clear();
  next.memory_.reset();
  next.view_.reset();
  if (config.run.method != "stillpoint") return next;
  for (const PastFrame& past : before) {
    if (!past.estimated || !past.frame.has_depth()) continue;
    const auto view = std::make_shared<const RgbdView>(
        make_rgbd_view(past.frame.gray, past.frame.depth, camera_, config.depth_motion.factor));
    next.past_views_.push_back({past.frame.index, view, past.camera_from_world});
    next.memory_ = MotionMemory{view, cv::Mat::zeros(view->depth.size(), CV_32FC1)};
  }
  return next;
}

}  // namespace stillpoint
