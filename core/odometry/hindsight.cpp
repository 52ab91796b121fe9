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

std::vector<Hindsight::Sight> sights_of(const TrackedFrame& frame, const std::vector<double>& scales) {
  std::vector<Hindsight::Sight> sights;
  const FeatureSet& features = *frame.features;
  for (std::size_t f = 0; f < frame.points.size(); ++f) {
    if (frame.points[f] == kNone) continue;
    const cv::Point2f pixel = features.undistorted[f];
    const auto octave = static_cast<std::size_t>(features.keypoints[f].octave);
    sights.push_back({frame.points[f], pixel.x, pixel.y, features.depth[f],
                      static_cast<float>(scales[octave]), features.trust[f]});
  }
  return sights;
}

}  // namespace stillpoint
