#pragma once

#include <vector>

#include "core/motion/dai2020/edge_memory.hpp"
#include "core/motion/motion_method.hpp"

namespace stillpoint {

/// What method `dai2020` saw of a frame.
struct Dai2020Trace final : MotionTrace {
  int last_index = -1;
  cv::Mat last_gray;  ///< CV_8UC1; empty where the graph begins
  std::vector<MotionFeature> features;
  std::vector<cv::Point2f> before;     ///< px: where each of the judged points was in the last frame
  std::vector<cv::Point2f> lost;       ///< px: where points were that could not be followed
  TrackedGraph judged;                 ///< followed, measured and judged
  PointGroups groups;                  ///< of its points
  int still = -1;                      ///< the static group
  std::vector<int> nearest;            ///< of each feature, the judged point it takes after; -1 = none
  std::vector<PointVerdict> verdicts;  ///< one a feature
  bool keyframe = false;
  int added = 0;      ///< points that came in
  TrackedGraph next;  ///< what later frames begin with
  double ms_follow = 0.0, ms_edges = 0.0, ms_groups = 0.0, ms_keyframe = 0.0;

  [[nodiscard]] int cut_edges() const;
};

/// The stages of method `dai2020`: points followed, strain, cuts, groups, features and the keyframe.
[[nodiscard]] StageLog describe_dai2020(const Frame& frame, const Dai2020Trace& trace,
                                        const Dai2020Config& config);

}  // namespace stillpoint
