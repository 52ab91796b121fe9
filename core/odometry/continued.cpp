// Going on with another config from the middle of a run.
#include "core/odometry/odometry.hpp"

namespace stillpoint {
namespace {

/// Whether views and memory made under `before` serve under `after`.
bool same_past_views(const Config& before, const Config& after) {
  return before.run.method == "stillpoint" && before.depth_motion.factor == after.depth_motion.factor &&
         before.depth_motion.far_reference >= after.depth_motion.far_reference;
}

bool compares_by_homography(const Config& config) {
  return config.run.method != "none" && config.run.method != "oracle" && config.run.method != "stillpoint";
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

std::optional<Odometry> Odometry::continued_with(const Config& config,
                                                 const std::vector<PastFrame>& before) const {
  if (config.features.levels != config_.features.levels ||
      config.features.scale_factor != config_.features.scale_factor)
    return std::nullopt;
  Odometry next = *this;
  next.config_ = config;
  next.preparer_ = FramePreparer(camera_, config);

  const bool keeps_references =
      compares_by_homography(config_) && compares_by_homography(config) && config.motion == config_.motion;
  for (const auto& reference : keeps_references ? preparer_.references() : motion_frames(before, config))
    next.preparer_.pass(reference);

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
