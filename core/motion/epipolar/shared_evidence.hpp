#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/motion/epipolar/epipolar_config.hpp"
#include "core/motion/epipolar/point_tracks.hpp"

namespace stillpoint {

/// Each track's evidence after smoothing with its neighbours: those that have moved alike in all the frames
/// both were seen in count most (as long-term trajectories tell things apart in Brox & Malik 2010), so that
/// what belongs together is judged together, and not across the outline of what is dynamic.
[[nodiscard]] std::vector<float> share_evidence(const std::vector<PointTrack>& tracks, cv::Size small,
                                                const EpipolarConfig& config);

/// Evidence over the image.
struct PropagatedEvidence {
  cv::Mat evidence;  ///< CV_32FC1: of the nearest point
  cv::Mat way;       ///< CV_32FC1: how far that is, px and changes of colour at config.colour_cost
};

/// Spreads the points' evidence over the image: a pixel takes that of the point it reaches with the least
/// change of colour on the way.
/// @param image CV_8UC3 or CV_8UC1, half the downsampled image's side
[[nodiscard]] PropagatedEvidence propagate_evidence(const cv::Mat& image,
                                                    const std::vector<PointTrack>& tracks,
                                                    const std::vector<float>& shared,
                                                    const EpipolarConfig& config);

}  // namespace stillpoint
