#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "core/motion/paper/lucas_kanade.hpp"
#include "core/motion/paper/paper_config.hpp"
#include "core/motion/paper/paper_trace.hpp"

namespace stillpoint {

/// A grey frame made ready for motion detection. Made once a frame: it is the target of one pair and the
/// reference of the next, and serves both directions and every round of each.
struct MotionFrame {
  cv::Mat gray;                      ///< CV_8UC1
  std::vector<cv::Mat> pyramid;      ///< Lucas-Kanade levels with their derivatives, as OpenCV lays them out
  std::vector<cv::Point2f> corners;  ///< px, strongest first
  std::shared_ptr<KnownSums> sums;   ///< of the corners' windows, which are followed forward and backward
};

/// The Shi-Tomasi corners and the pyramid of a frame. A frame smaller than kMinMotionSide gets neither.
/// @param gray CV_8UC1; shared, not copied
[[nodiscard]] MotionFrame prepare_motion_frame(const cv::Mat& gray, const PaperConfig& config);

/// Frames with a side shorter than this, in px, are too small to follow corners in.
inline constexpr int kMinMotionSide = 32;

/// METHOD.md §1 step 1: the corners of `source` followed into `destination` by pyramidal Lucas-Kanade.
/// Corners that are lost, leave the image or no longer look alike (PaperConfig::flow_max_residual) are
/// dropped.
/// @param source,destination prepared with the same `config`
[[nodiscard]] std::vector<Track> follow_corners(const MotionFrame& source, const MotionFrame& destination,
                                                const PaperConfig& config);

/// Which end of a track a mask is looked up at.
enum class TrackEnd { kFrom, kTo };

/// Marks the tracks whose `end` lies in `mask` as removed, and all others as not removed.
/// @param mask CV_8UC1, non-zero = moving, or empty: then none is removed
/// @return how many tracks changed sides
int remove_moving_tracks(std::vector<Track>& tracks, TrackEnd end, const cv::Mat& mask);

}  // namespace stillpoint
