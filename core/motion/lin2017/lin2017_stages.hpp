#pragma once

#include <memory>
#include <vector>

#include "core/motion/feature_pose.hpp"
#include "core/motion/lin2017/feature_flow.hpp"
#include "core/motion/lin2017/virtual_points.hpp"
#include "core/motion/motion_method.hpp"

namespace stillpoint {

/// A round of method `lin2017`: a pose, and what is held of the features under it.
struct Lin2017Round {
  Pose here_from_last = Pose::Identity();
  FeaturePose pose;  ///< solved for this round; the odometry's first pose, with its covariance, in round 0
  std::vector<FeatureFlow> flows;  ///< one a feature
  std::vector<int> things;         ///< classes of direction that are things that move
  double ms = 0.0;
};

/// What method `lin2017` saw of a frame.
struct Lin2017Trace final : MotionTrace {
  int last_index = -1;
  cv::Mat last_gray;  ///< CV_8UC1
  std::vector<MotionFeature> features;
  std::vector<VirtualPoint> virtual_before;  ///< moved on to this frame, in its camera
  std::vector<cv::Point2f> virtual_pixels;   ///< where they lie
  std::vector<int> virtual_matches;          ///< feature of each, or -1
  std::vector<Lin2017Round> rounds;
  std::vector<VirtualPoint> virtual_after;  ///< in this frame's camera
  double ms_follow = 0.0, ms_virtual = 0.0;

  [[nodiscard]] int count(FeatureClass kind) const;  ///< of the last round's features
};

/// The stages of method `lin2017`: virtual points, features followed, and a round after the other scene flow
/// and classes.
[[nodiscard]] StageLog describe_lin2017(const Frame& frame, const Lin2017Trace& trace,
                                        const Lin2017Config& config);

}  // namespace stillpoint
