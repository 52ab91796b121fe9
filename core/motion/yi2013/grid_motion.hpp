#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/motion/yi2013/yi2013_config.hpp"

namespace stillpoint {

// The camera's motion as method `yi2013` finds it: a homography of grid points followed to the last frame.

/// A grid point followed from this frame to the last.
struct Yi2013Track {
  cv::Point2f here, there;  ///< px, in this frame and in the last
  bool inlier = false;      ///< it agrees with the homography
};

/// The camera's motion as an image motion.
struct Yi2013Motion {
  int points = 0;                   ///< of the grid
  std::vector<Yi2013Track> tracks;  ///< those that could be followed
  int inliers = 0;
  cv::Matx33d last_from_here = cv::Matx33d::eye();
  std::string note;  ///< why the homography is the identity; empty when it was measured
};

/// A filtered frame as yi2013_motion takes it.
[[nodiscard]] std::vector<cv::Mat> yi2013_pyramid(const cv::Mat& gray, const Yi2013Config& config);

/// Pyramids as cv::buildOpticalFlowPyramid makes them of the filtered frames, with config's window and
/// levels.
[[nodiscard]] Yi2013Motion yi2013_motion(const std::vector<cv::Mat>& here, const std::vector<cv::Mat>& last,
                                         const Yi2013Config& config);

}  // namespace stillpoint
