#include "core/odometry/frame_preparer.hpp"

#include <future>

#include "core/motion/segments.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {

FramePreparer::FramePreparer(const Camera& camera, const Config& config)
    : camera_(camera), config_(config), extractor_(config.features) {}

PreparedFrame FramePreparer::prepare(const Frame& frame, bool beside_tracking) {
  PreparedFrame prepared;
  // Method `stillpoint` tracks for longer than it prepares: what a second thread would gain here it would
  // take from there, unless there is a third.
  const bool tracking_is_longer = beside_tracking && config_.run.method == "stillpoint";
  const int threads = tracking_is_longer ? config_.run.threads - 1 : config_.run.threads;
  const auto find_features = [&] {
    const Stopwatch watch;
    prepared.found = extractor_.extract(frame.gray, threads);
    cv::KeyPoint::convert(prepared.found.keypoints, prepared.pixels);
    prepared.undistorted = camera_.undistort(prepared.pixels);
    prepared.features_ms = watch.milliseconds();
  };
  const bool beside = config_.run.threads > 1 && config_.run.method == "paper";
  // METHOD.md §1 beside ORB extraction: neither needs the other's result.
  auto features = std::async(beside ? std::launch::async : std::launch::deferred, find_features);
  const Stopwatch watch;
  if (config_.run.method == "paper") {
    prepared.motion_frame =
        std::make_shared<const MotionFrame>(prepare_motion_frame(frame.gray, config_.motion));
    if (!references_.empty())
      prepared.motion =
          detect_motion(*references_.front(), *prepared.motion_frame, config_.motion, config_.run.threads);
  } else if (config_.run.method == "stillpoint") {
    prepared.view = std::make_shared<const RgbdView>(
        make_rgbd_view(frame.gray, frame.depth, camera_, config_.depth_motion.factor));
    prepared.patches = segment_surfaces(*prepared.view, config_.depth_motion);
  }
  prepared.motion_ms = watch.milliseconds();
  features.get();
  pass(prepared.motion_frame);
  return prepared;
}

void FramePreparer::pass(const std::shared_ptr<const MotionFrame>& motion_frame) {
  if (!motion_frame) return;
  references_.push_back(motion_frame);
  while (static_cast<int>(references_.size()) > config_.motion.reference_gap) references_.pop_front();
}

}  // namespace stillpoint
