#include "core/odometry/hindsight.hpp"

namespace stillpoint {

void Hindsight::remember(int frame_index, const HangingPose& pose, std::vector<Sight> sights) {
  Past past{frame_index, pose, {}, std::move(sights)};
  past.points.reserve(past.sights.size());
  for (const Sight& sight : past.sights) past.points.push_back(sight.point);
  past_.push_back(std::make_shared<const Past>(std::move(past)));
}

void Hindsight::look_back(int last, const LocalMap& map, const Camera& camera, const TrackingConfig& config) {
  for (; !past_.empty() && past_.front()->frame_index <= last; past_.pop_front()) {
    const Past& past = *past_.front();
    std::vector<PoseObservation> left;
    left.reserve(past.sights.size());
    for (const Sight& sight : past.sights)
      if (map.has_point(sight.point))
        left.push_back(
            {map.point(sight.point).position, {sight.u, sight.v}, sight.depth, sight.sigma_px, sight.trust});
    const Pose reference = map.pose_of(past.pose.reference_keyframe);
    const PoseRefinement refined =
        refine_pose(camera, left, past.pose.camera_from_reference * reference, config);
    if (refined.inliers >= config.min_inliers)
      revised_[past.frame_index] = {past.pose.reference_keyframe,
                                    refined.camera_from_world * reference.inverse()};
  }
}

std::vector<const std::vector<int>*> Hindsight::points() const {
  std::vector<const std::vector<int>*> points;
  for (const auto& past : past_) points.push_back(&past->points);
  return points;
}

}  // namespace stillpoint
