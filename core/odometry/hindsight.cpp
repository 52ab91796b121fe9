#include "core/odometry/hindsight.hpp"

#include <algorithm>

namespace stillpoint {

void Hindsight::remember(int frame_index, const HangingPose& pose, std::vector<Sight> sights) {
  past_.push_back(std::make_shared<const Past>(Past{frame_index, pose, std::move(sights)}));
}

void Hindsight::look_back(int last, const LocalMap& map, const Camera& camera, const TrackingConfig& config) {
  constexpr int kLeastShare = 3;  // one in so many of a frame's matches must be left and agree
  for (; !past_.empty() && past_.front()->frame_index <= last; past_.pop_front()) {
    const Past& past = *past_.front();
    std::vector<PoseObservation> left;
    left.reserve(past.sights.size());
    for (const Sight& sight : past.sights) {
      if (!map.has_point(sight.point)) continue;
      const Eigen::Vector3d& point = map.point(sight.point).position;
      left.push_back({point, {sight.u, sight.v}, sight.depth, sight.sigma_px, sight.trust});
    }
    const Pose reference = map.pose_of(past.pose.reference_keyframe);
    const PoseRefinement refined =
        refine_pose(camera, left, past.pose.camera_from_reference * reference, config);
    const int needed = std::max(config.min_inliers, static_cast<int>(past.sights.size()) / kLeastShare);
    if (refined.inliers >= needed)
      revised_[past.frame_index] = {past.pose.reference_keyframe,
                                    refined.camera_from_world * reference.inverse()};
  }
}

}  // namespace stillpoint
