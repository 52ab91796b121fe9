#include "core/odometry/frame_preparer.hpp"

#include <future>

#include "core/odometry/engines.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {

FramePreparer::FramePreparer(const Camera& camera, const Config& config)
    : camera_(camera),
      extractor_(config.features),
      motion_(camera, config),
      threads_(config.run.threads),
      judged_by_pose_(method_of(config).needs.first_pose),
      wants_orb_(engine_of(config).wants_orb) {}

PreparedFrame FramePreparer::prepare(const Frame& frame, bool beside_tracking) {
  PreparedFrame prepared;
  // A method that judges under a pose tracks for longer than it prepares: what a second thread would gain
  // here it would take from there, unless there is a third.
  const int threads = beside_tracking && judged_by_pose_ ? threads_ - 1 : threads_;
  const auto find_features = [&] {
    if (!wants_orb_) return;
    const Stopwatch watch;
    prepared.found = extractor_.extract(frame.gray, threads);
    cv::KeyPoint::convert(prepared.found.keypoints, prepared.pixels);
    prepared.undistorted = camera_.undistort(prepared.pixels);
    prepared.features_ms = watch.milliseconds();
  };
  // A method that compares prepared frames works beside ORB extraction: neither needs the other's result.
  const bool beside = threads_ > 1 && motion_.frames_back() > 0;
  auto features = std::async(beside ? std::launch::async : std::launch::deferred, find_features);
  const Stopwatch watch;
  prepared.motion = motion_.prepare(frame, threads_);
  prepared.motion_ms = watch.milliseconds();
  features.get();
  return prepared;
}

}  // namespace stillpoint
