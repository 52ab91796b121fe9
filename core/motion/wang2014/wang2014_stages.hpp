#pragma once

#include <memory>

#include "core/motion/motion_method.hpp"
#include "core/motion/wang2014/motion_segments.hpp"

namespace stillpoint {

/// What method `wang2014` saw of a frame.
struct Wang2014Trace final : MotionTrace {
  std::shared_ptr<const TrajectoryFrame> here, last;  ///< last: null where trajectories begin anew
  std::shared_ptr<const TrajectorySet> trajectories;
  std::shared_ptr<const MotionSegments> segments;  ///< of this frame; null where the mask was carried
  cv::Mat labels;                                  ///< CV_8UC1, small: found, or carried
  cv::Mat small_mask;                              ///< CV_8UC1, small
  cv::Mat mask;                                    ///< CV_8UC1, full size
  int since = 0;                                   ///< frames since the last segmentation
  double ms_flow = 0.0, ms_follow = 0.0, ms_mask = 0.0;
};

/// The stages of method `wang2014`: trajectories, affinities of one of them, eigenvectors, clusters, merging,
/// labels and mask; or trajectories and the carried mask.
[[nodiscard]] StageLog describe_wang2014(const Frame& frame, const Wang2014Trace& trace,
                                         const Wang2014Config& config);

}  // namespace stillpoint
