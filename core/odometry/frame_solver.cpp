#include "core/odometry/frame_solver.hpp"

#include <fmt/format.h>

#include "core/motion/methods.hpp"

namespace stillpoint {

FrameSolver::FrameSolver(const Camera& camera, const Config& config)
    : features_(camera, config.tracking),
      tracker_(camera, config),
      direct_(camera, config),
      config_(config),
      camera_(camera),
      judged_by_pose_(method_of(config).needs.first_pose) {}

void FrameSolver::adopt(const Config& config) {
  features_ = StaticFeatures(camera_, config.tracking);
  tracker_.adopt(config);
  direct_.adopt(config);
  config_ = config;
  judged_by_pose_ = method_of(config).needs.first_pose;
}

bool FrameSolver::needs_first_pose(const Frame& image) const {
  return judged_by_pose_ || features_.depend_on_velocity(image);
}

FrameSolver::FirstPose FrameSolver::predict(const Frame& image, const LocalMap& map) const {
  FirstPose predicted;
  predicted.camera_from_world = path().predicted(map, image.timestamp);
  predicted.velocity = path().velocity();
  return predicted;
}

FrameSolver::FirstPose FrameSolver::first_pose(const Frame& image, const PreparedFrame& prepared,
                                               const cv::Mat& mask, const LocalMap& map, bool motion_settled,
                                               FrameRecord& record) {
  FirstPose first = predict(image, map);
  TrackedFrame& seen = first.seen;
  seen = features_.select(image, prepared, mask, path().velocity());
  seen.start_from(first.camera_from_world, false);
  std::optional<std::uint32_t> consensus_seed;
  if (judged_by_pose_ && config_.tracking.seek_consensus)
    consensus_seed = static_cast<std::uint32_t>(config_.run.seed) + static_cast<std::uint32_t>(image.index);
  first.found = tracker_.estimate(map, seen, record, consensus_seed);
  if (direct_.enabled()) {
    const bool starved = direct_.starts_degraded(seen) && motion_settled;
    if (starved || !first.found) first.found = direct_.begin(image, map, path(), seen, record) || first.found;
  }
  if (!first.found) return first;
  first.agreed = seen.agreed;
  first.camera_from_world = seen.camera_from_world;
  first.velocity = path().velocity_to(first.camera_from_world, map, image.timestamp);
  return first;
}

FrameSolver::Solution FrameSolver::solve(const Frame& image, const PreparedFrame& prepared,
                                         const cv::Mat& mask, const MotionResult& motion,
                                         const FirstPose& first, const LocalMap& map,
                                         FrameRecord& record) const {
  Solution solution;
  solution.frame = features_.select(image, prepared, mask, first.velocity, motion);  // §1.6, §2.1
  solution.frame.start_from(first.camera_from_world, first.agreed);
  solution.withdrawn = judged_by_pose_ && features_.too_few_places(solution.frame);
  if (!solution.withdrawn) {
    track(image, map, solution, record);
    solution.withdrawn = judged_by_pose_ && !solution.found() && solution.frame.lost_features();
  }
  if (solution.withdrawn) {
    solution.frame = features_.select(image, prepared, {}, first.velocity);
    solution.frame.start_from(first.camera_from_world, first.agreed);
    track(image, map, solution, record);
  }
  return solution;
}

void FrameSolver::track(const Frame& image, const LocalMap& map, Solution& solution,
                        FrameRecord& record) const {
  TrackedFrame& frame = solution.frame;
  const int needed = tracker_.inliers_needed();
  PoseRefinement refined;
  const bool begun = tracker_.estimate(map, frame, record);               // §2.2: EPnP inside RANSAC
  if (begun) refined = tracker_.refine_by_local_map(map, frame, record);  // §2.3, eq. (5)
  solution.directly =
      direct_.is_degraded(refined.inliers) && direct_.refine(image, map, tracker_, frame, refined, record);
  solution.inliers = refined.inliers;
  // That a blurred frame does not show a point's corner tells nothing of the point.
  if (begun && !solution.directly) {
    solution.points_in_view.insert(solution.points_in_view.end(), frame.points_in_view.begin(),
                                   frame.points_in_view.end());
    solution.points_found.insert(solution.points_found.end(), frame.points_found.begin(),
                                 frame.points_found.end());
  }
  if (!begun && !solution.directly)
    solution.why_lost =
        fmt::format("{} of {} features match the local map; {} must agree with a pose", record.matches,
                    frame.features->size(), config_.tracking.min_initial_matches);
  else if (refined.inliers < needed && !solution.directly)
    solution.why_lost = fmt::format("{} matches agree with the pose; {} are needed", refined.inliers, needed);
  else
    solution.why_lost.clear();
}

}  // namespace stillpoint
