#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace stillpoint {

/// A connected region of a mask.
struct MotionRegion {
  cv::Rect box;          ///< px
  cv::Point2d centroid;  ///< px
  int area = 0;          ///< px
};

/// The connected regions of a mask and where each lies.
struct LabelledRegions {
  cv::Mat labels;  ///< CV_32SC1: 0, or 1 + index into `regions`
  std::vector<MotionRegion> regions;
  int area = 0;  ///< px, of all regions together
};

/// METHOD.md §1 step 6: the regions of interest, 8-connected, in the order their first pixels are read.
/// @param mask CV_8UC1, non-zero = moving
[[nodiscard]] LabelledRegions find_regions(const cv::Mat& mask);

}  // namespace stillpoint
