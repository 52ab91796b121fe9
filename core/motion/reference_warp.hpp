#pragma once

#include "core/motion/depth_motion.hpp"

namespace stillpoint {

/// What an earlier frame shows where the current one's pixels lie under the camera's motion: the two are
/// alike where nothing moved. For looking at; detection compares the same places.
struct ReferenceWarp {
  cv::Mat gray;   ///< CV_32FC1, grey levels; NaN where the pixel has no depth or lies outside the reference
  cv::Mat shift;  ///< CV_32FC1, px of the small image between a pixel and its place in the reference; NaN as
                  ///< above
};

/// @param current the small view of the frame at hand
[[nodiscard]] ReferenceWarp warp_reference(const RgbdView& current, const ReferenceView& reference);

}  // namespace stillpoint
