#pragma once

#include <memory>
#include <vector>

#include "core/motion/alcantarilla2012/flow_test.hpp"
#include "core/motion/feature_pose.hpp"
#include "core/motion/motion_method.hpp"

namespace stillpoint {

/// A round of method `alcantarilla2012`: a pose, and the test under it.
struct Alcantarilla2012Round {
  FeaturePose pose;  ///< the odometry's first pose in round 0, with its covariance; then solved again
  Pose here_from_last = Pose::Identity();
  int left_out = 0;  ///< features taken out before the pose was solved
  FlowTest test;
  double ms_pose = 0.0, ms_test = 0.0;
};

/// What method `alcantarilla2012` saw of a frame.
struct Alcantarilla2012Trace final : MotionTrace {
  std::shared_ptr<const FlowImages> here, last;
  FlowPair flow;
  cv::Mat judged;  ///< CV_8UC1, small: 255 where a pixel is judged
  std::vector<Alcantarilla2012Round> rounds;
  double contradicted = 0.0;  ///< share of the features that agree with the first pose and lie on what moves
  double ms_flow = 0.0, ms_pairs = 0.0;
  cv::Mat mask;  ///< CV_8UC1, full size
};

/// The stages of method `alcantarilla2012`: flow, pairs, and a round after the other pose, residual motion,
/// ξ² and vote.
[[nodiscard]] StageLog describe_alcantarilla2012(const Frame& frame, const Alcantarilla2012Trace& trace,
                                                 const Alcantarilla2012Config& config);

}  // namespace stillpoint
