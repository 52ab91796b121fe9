#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace stillpoint {

/// Shi-Tomasi corners (Shi & Tomasi 1994): pixels whose smaller eigenvalue of the 3x3-summed gradient matrix
/// is a local maximum. As cv::goodFeaturesToTrack, but from the gradients that the Lucas-Kanade pyramid holds
/// already, at a fraction of its time.
/// @param gradients CV_16SC2: the image's Scharr derivatives along x and y
/// @param quality least response, as a share of the best corner's
/// @param distance_px least distance between two corners, at least 1; of two too close the stronger stays
/// @return at most `max_corners`, in px, strongest first
[[nodiscard]] std::vector<cv::Point2f> find_corners(const cv::Mat& gradients, int max_corners, double quality,
                                                    double distance_px);

}  // namespace stillpoint
