#pragma once

#include <vector>

#include "core/motion/motion_method.hpp"
#include "core/motion/peng2017/held_edges.hpp"
#include "core/motion/peng2017/peng2017_config.hpp"

namespace stillpoint {

/// What method `peng2017` saw of a frame.
struct Peng2017Trace final : MotionTrace {
  int last_index = -1;
  cv::Mat last_gray;  ///< CV_8UC1
  std::vector<MotionFeature> features;
  std::vector<cv::Point2f> unmeasured;  ///< px: features not followed, or without depth at one end
  std::vector<GraphPoint> here, last;   ///< the graph's points in both frames
  std::vector<PointPair> edges;
  std::vector<double> strains;         ///< one an edge, σ
  std::vector<float> shares;           ///< one a point: share of its edges that hold; NaN = none
  std::vector<PointVerdict> of_point;  ///< one a point
  std::vector<int> nearest;            ///< of each feature, the point it takes after; -1 = none
  std::vector<PointVerdict> verdicts;  ///< one a feature
  double ms_follow = 0.0, ms_edges = 0.0;

  [[nodiscard]] int cut_edges(double sigmas) const;
};

/// The stages of method `peng2017`: points, strain of the edges, shares that hold, features.
[[nodiscard]] StageLog describe_peng2017(const Frame& frame, const Peng2017Trace& trace,
                                         const Peng2017Config& config);

}  // namespace stillpoint
