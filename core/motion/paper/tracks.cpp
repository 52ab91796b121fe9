#include "core/motion/paper/tracks.hpp"

#include <algorithm>
#include <opencv2/video/tracking.hpp>

#include "core/motion/paper/corners.hpp"

namespace stillpoint {
namespace {

/// A corner has arrived when a step is shorter than 0.03 px, a tenth of what tracks scatter by anyway.
const cv::TermCriteria kFlowStop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 0.03);

bool inside(const cv::Point2f& point, const cv::Size& size) {
  return point.x >= 0.0F && point.y >= 0.0F && point.x <= static_cast<float>(size.width - 1) &&
         point.y <= static_cast<float>(size.height - 1);
}

}  // namespace

MotionFrame prepare_motion_frame(const cv::Mat& gray, const PaperConfig& config) {
  MotionFrame frame;
  frame.gray = gray;
  if (std::min(gray.cols, gray.rows) < kMinMotionSide) return frame;
  // A frame is the source of one direction and the destination of the other, hence derivatives for all.
  const bool with_derivatives = true;
  cv::buildOpticalFlowPyramid(gray, frame.pyramid, {config.flow_window_px, config.flow_window_px},
                              config.flow_levels, with_derivatives);
  const cv::Mat& gradients = frame.pyramid[1];  // levels and their derivatives take turns
  frame.corners =
      find_corners(gradients, config.max_corners, config.corner_quality, config.corner_distance_px);
  return frame;
}

std::vector<Track> follow_corners(const MotionFrame& source, const MotionFrame& destination,
                                  const PaperConfig& config) {
  std::vector<Track> tracks;
  if (source.corners.empty()) return tracks;
  std::vector<cv::Point2f> moved;
  std::vector<unsigned char> found;
  std::vector<float> residuals;  // without OPTFLOW_LK_GET_MIN_EIGENVALS: mean absolute grey-level difference
  cv::calcOpticalFlowPyrLK(source.pyramid, destination.pyramid, source.corners, moved, found, residuals,
                           {config.flow_window_px, config.flow_window_px}, config.flow_levels, kFlowStop);
  tracks.reserve(moved.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const bool good = found[i] != 0 && static_cast<double>(residuals[i]) <= config.flow_max_residual &&
                      inside(moved[i], destination.gray.size());
    if (good) tracks.push_back({.from = source.corners[i], .to = moved[i], .residual = residuals[i]});
  }
  return tracks;
}

int remove_moving_tracks(std::vector<Track>& tracks, TrackEnd end, const cv::Mat& mask) {
  int changed = 0;
  for (Track& track : tracks) {
    const cv::Point2f& at = end == TrackEnd::kFrom ? track.from : track.to;
    const bool moving = !mask.empty() && mask.at<unsigned char>(cvRound(at.y), cvRound(at.x)) != 0;
    if (moving != track.removed) ++changed;
    track.removed = moving;
  }
  return changed;
}

}  // namespace stillpoint
