#include "core/odometry/removal_check.hpp"

#include <future>

#include "core/geometry/normal_equations.hpp"

namespace stillpoint {
namespace {

/// What the judgement says beside what it removes.
MotionResult weights_of(const MotionResult& motion) {
  MotionResult weights;
  weights.log_odds = motion.log_odds;
  weights.weight_of_feature = motion.weight_of_feature;
  for (float& weight : weights.weight_of_feature)
    if (weight <= 0.0F) weight = 1.0F;
  return weights;
}

/// The steps of FeatureOdometry::track_frame as far as the pose, on copies.
/// A pose, and how well it is known.
struct SolvedPose {
  std::optional<Pose> world_from_camera;
  double sigma_m = 0.0;
};
SolvedPose solve_with_mask(BeforeFrame before, const Frame& image, const PreparedFrame& prepared,
                           const cv::Mat& mask, const MotionResult& weights, bool judged_by_pose) {
  FrameSolver& solver = before.solver;
  const LocalMap& map = before.mapper.map();
  FrameRecord record;  // of which the covariance is kept
  FrameSolver::FirstPose first = solver.predict(image, map);
  if (solver.needs_first_pose(image)) {
    first = solver.first_pose(image, prepared, mask, map, before.motion_settled, record);
    if (first.found && judged_by_pose)
      before.mapper.remove_dynamic_points(image, mask, first.camera_from_world,
                                          solver.path().last().reference_keyframe);
  }
  const FrameSolver::Solution solution = solver.solve(image, prepared, mask, weights, first, map, record);
  if (!solution.found()) return {};
  return {solution.frame.camera_from_world.inverse(),
          largest_deviation(record.pose_covariance.topLeftCorner<3, 3>())};
}

}  // namespace

RemovalCheck check_removal(const BeforeFrame& before, const Frame& image, const PreparedFrame& prepared,
                           const MotionResult& motion, bool judged_by_pose, const cv::Mat& known_mask,
                           int threads) {
  const MotionResult weights = weights_of(motion);
  const auto solve = [&](const cv::Mat& mask) {
    return solve_with_mask(before, image, prepared, mask, weights, judged_by_pose);
  };
  RemovalCheck check;
  std::future<SolvedPose> told;
  if (known_mask.size() == image.gray.size())
    told = std::async(threads > 1 ? std::launch::async : std::launch::deferred,
                      [&] { return solve(known_mask); });
  const SolvedPose all = solve({});
  check.nothing_removed = all.world_from_camera;
  check.nothing_removed_sigma_m = all.sigma_m;
  if (told.valid()) check.truth_removed = told.get().world_from_camera;
  return check;
}

}  // namespace stillpoint
