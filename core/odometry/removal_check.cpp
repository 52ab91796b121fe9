// The pose of a frame as it would be had other features been taken out: beside the run, and of no effect on
// it.
#include <future>

#include "core/odometry/odometry.hpp"

namespace stillpoint {

RemovalCheck Odometry::check_removal(const Frame& frame, const PreparedFrame& prepared,
                                     const cv::Mat& known_mask) const {
  RemovalCheck check;
  std::future<std::optional<Pose>> told;
  if (known_mask.size() == frame.gray.size())
    told = std::async(config_.run.threads > 1 ? std::launch::async : std::launch::deferred,
                      [&] { return solve_with_mask(frame, prepared, known_mask); });
  check.nothing_removed = solve_with_mask(frame, prepared, {});
  if (told.valid()) check.truth_removed = told.get();
  return check;
}

std::optional<Pose> Odometry::solve_with_mask(const Frame& frame, const PreparedFrame& prepared,
                                              const cv::Mat& mask) const {
  FrameRecord unused;
  Pose start = predicted_camera_from_world();
  Vector6d velocity = velocity_;
  if (!is_taken_at_once(frame)) {
    Current first = remove_moving(frame, prepared, mask, velocity, unused);
    first.camera_from_world = start;
    if (estimate(first, unused)) {
      start = first.camera_from_world;
      velocity = se3_log(start * last_camera_from_world().inverse()) / elapsed();
    }
  }
  Current current = remove_moving(frame, prepared, mask, velocity, unused);
  current.camera_from_world = start;
  if (!estimate(current, unused)) return std::nullopt;
  if (track_local_map(current, unused).inliers < inliers_needed()) return std::nullopt;
  return current.camera_from_world.inverse();
}

}  // namespace stillpoint
