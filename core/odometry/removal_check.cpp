#include "core/odometry/removal_check.hpp"

#include <future>

namespace stillpoint {
namespace {

std::optional<Pose> solve_with_mask(const FrameSolver& solver, const LocalMap& map, const Frame& image,
                                    const PreparedFrame& prepared, const cv::Mat& mask) {
  FrameRecord unused;
  const CameraPath& path = solver.path();
  Pose start = path.predicted(map, image.timestamp);
  Vector6d velocity = path.velocity();
  if (solver.features().depend_on_velocity(image)) {
    TrackedFrame first = solver.features().select(image, prepared, mask, velocity);
    first.camera_from_world = start;
    if (solver.tracker().estimate(map, first, unused)) {
      start = first.camera_from_world;
      velocity = path.velocity_to(start, map, image.timestamp);
    }
  }
  TrackedFrame frame = solver.features().select(image, prepared, mask, velocity);
  frame.camera_from_world = start;
  if (!solver.tracker().estimate(map, frame, unused)) return std::nullopt;
  if (solver.tracker().refine_by_local_map(map, frame, unused).inliers < solver.tracker().inliers_needed())
    return std::nullopt;
  return frame.camera_from_world.inverse();
}

}  // namespace

RemovalCheck check_removal(const FrameSolver& solver, const LocalMap& map, const Frame& image,
                           const PreparedFrame& prepared, const cv::Mat& known_mask, int threads) {
  RemovalCheck check;
  std::future<std::optional<Pose>> told;
  if (known_mask.size() == image.gray.size())
    told = std::async(threads > 1 ? std::launch::async : std::launch::deferred,
                      [&] { return solve_with_mask(solver, map, image, prepared, known_mask); });
  check.nothing_removed = solve_with_mask(solver, map, image, prepared, {});
  if (told.valid()) check.truth_removed = told.get();
  return check;
}

}  // namespace stillpoint
