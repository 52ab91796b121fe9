#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"

namespace stillpoint {

/// A rolling shutter takes the rows of an image one after the other while the camera moves on. Carries
/// features to where a frame taken all at once, at its middle row, would show them; depth with them. Without
/// it a hand-held Kinect's frames bend by some pixels from top to bottom (Ringaby & Forssen 2011).
/// @param velocity of the camera, a second: log(now_from_before) over the time between; translation first
/// @param pixels in the image as it is: their row tells when they were taken
/// @param undistorted the same as a pinhole would see them, moved in place; @param depth m, 0 = none, moved
/// in place.
///        Features without depth are carried as if they lay at the median depth.
void correct_rolling_shutter(const Camera& camera, const Vector6d& velocity,
                             const std::vector<cv::Point2f>& pixels, std::vector<cv::Point2f>& undistorted,
                             std::vector<float>& depth);

}  // namespace stillpoint
