#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace stillpoint {

/// Where points went, in the order of the points given.
struct FollowedPoints {
  std::vector<cv::Point2f> to;       ///< px
  std::vector<unsigned char> found;  ///< 0 = lost: `to` means nothing
  std::vector<float> residuals;      ///< mean absolute grey-level difference of the two windows; 0 where lost
};

/// How points are followed.
struct FlowSettings {
  int window_px = 21;           ///< side of the window
  int levels = 3;               ///< pyramid levels above the full image
  int max_steps = 20;           ///< a level
  double least_step_px = 0.03;  ///< a point has arrived when a step is shorter
};

/// Pyramidal Lucas-Kanade (Bouguet 2000): what cv::calcOpticalFlowPyrLK computes of the same pyramids, to the
/// last bit with Debian 12's OpenCV. With AVX2 and a window of 21 px it is computed here, in a fraction
/// of the time; elsewhere OpenCV is asked.
/// @param source,destination from cv::buildOpticalFlowPyramid of one window, with derivatives
/// @param points px in `source`
[[nodiscard]] FollowedPoints follow_points(const std::vector<cv::Mat>& source,
                                           const std::vector<cv::Mat>& destination,
                                           const std::vector<cv::Point2f>& points,
                                           const FlowSettings& settings);

}  // namespace stillpoint
