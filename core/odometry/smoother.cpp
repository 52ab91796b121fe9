#include "core/odometry/smoother.hpp"

#include <algorithm>

namespace stillpoint {

void RevisedPoses::add(int frame, const KeyframeRelativePose& pose) {
  Entry entry{frame, pose.reference_keyframe, {}};
  Eigen::Map<Eigen::Matrix<double, 3, 4>>(entry.camera_from_reference.data()) =
      pose.camera_from_reference.matrix().topRows<3>();
  all_.push_back(entry);
}

std::optional<KeyframeRelativePose> RevisedPoses::of(int frame) const {
  const auto at = std::lower_bound(all_.begin(), all_.end(), frame,
                                   [](const Entry& entry, int index) { return entry.frame < index; });
  if (at == all_.end() || at->frame != frame) return std::nullopt;
  KeyframeRelativePose pose{at->reference_keyframe, Pose::Identity()};
  pose.camera_from_reference.matrix().topRows<3>() =
      Eigen::Map<const Eigen::Matrix<double, 3, 4>>(at->camera_from_reference.data());
  return pose;
}

void FixedLagSmoother::remember(int frame_index, const KeyframeRelativePose& pose,
                                std::vector<InlierMatch> matches) {
  past_.push_back(std::make_shared<const Past>(Past{frame_index, pose, std::move(matches)}));
}

void FixedLagSmoother::advance(int last, const LocalMap& map, const Camera& camera,
                               const TrackingConfig& config) {
  constexpr int kLeastShare = 3;  // one in so many of a frame's matches must be left and agree
  for (; !past_.empty() && past_.front()->frame_index <= last; past_.pop_front()) {
    const Past& past = *past_.front();
    std::vector<PoseObservation> left;
    left.reserve(past.matches.size());
    for (const InlierMatch& match : past.matches) {
      if (!map.has_point(match.point)) continue;
      const Eigen::Vector3d& point = map.point(match.point).position;
      left.push_back({point, {match.u, match.v}, match.depth, match.sigma_px, match.static_weight});
    }
    const Pose reference = map.pose_of(past.pose.reference_keyframe);
    const PoseRefinement refined =
        refine_pose(camera, left, past.pose.camera_from_reference * reference, config);
    const int needed = std::max(config.min_inliers, static_cast<int>(past.matches.size()) / kLeastShare);
    if (refined.inliers >= needed)
      revised_.add(past.frame_index,
                   {past.pose.reference_keyframe, refined.camera_from_world * reference.inverse()});
  }
}

std::vector<FixedLagSmoother::InlierMatch> inlier_matches_of(const TrackedFrame& frame,
                                                             const std::vector<double>& scales) {
  std::vector<FixedLagSmoother::InlierMatch> matches;
  const FeatureSet& features = *frame.features;
  const auto none = std::count(frame.points.begin(), frame.points.end(), kNone);
  matches.reserve(frame.points.size() - static_cast<std::size_t>(none));
  for (std::size_t f = 0; f < frame.points.size(); ++f) {
    if (frame.points[f] == kNone) continue;
    const cv::Point2f pixel = features.undistorted[f];
    const auto octave = static_cast<std::size_t>(features.keypoints[f].octave);
    matches.push_back({frame.points[f], pixel.x, pixel.y, features.depth[f],
                       static_cast<float>(scales[octave]), features.static_weight[f]});
  }
  return matches;
}

}  // namespace stillpoint
