#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/wide_lanes.hpp"

namespace stillpoint {

/// Appends FAST corners (Rosten & Drummond 2006; nine in a row of sixteen) to `corners`, row by row: what
/// cv::FAST finds, and with the same response, but sixteen or 32 pixels at a time also where corners are
/// weighed and compared with their neighbours, which on a textured image is most of the work.
/// @param image CV_8UC1
/// @param where px of the image that may be corners; must keep 3 px from its edges. A corner is compared with
/// its neighbours inside `where` alone.
/// @param threshold grey levels by which the nine must differ, at least 1
/// @param wide 32 pixels at a time, for processors that have such lanes; the corners are the same
void append_fast_corners(const cv::Mat& image, const cv::Rect& where, int threshold,
                         std::vector<cv::KeyPoint>& corners, bool wide = has_wide_lanes());

}  // namespace stillpoint
