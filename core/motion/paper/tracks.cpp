#include "core/motion/paper/tracks.hpp"

#include <algorithm>
#include <opencv2/video/tracking.hpp>

#include "core/motion/paper/corners.hpp"
#include "core/motion/paper/lucas_kanade.hpp"

namespace stillpoint {
namespace {

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
  frame.sums = std::make_shared<KnownSums>();
  return frame;
}

std::vector<Track> follow_corners(const MotionFrame& source, const MotionFrame& destination,
                                  const PaperConfig& config) {
  std::vector<Track> tracks;
  if (source.corners.empty()) return tracks;
  // A corner has arrived when a step is shorter than 0.03 px, a tenth of what tracks scatter by anyway.
  const auto [to, found, residuals] = follow_points(source.pyramid, destination.pyramid, source.corners,
                                                    {.window_px = config.flow_window_px,
                                                     .levels = config.flow_levels,
                                                     .max_steps = 20,
                                                     .least_step_px = 0.03},
                                                    source.sums.get());
  tracks.reserve(to.size());
  for (std::size_t i = 0; i < to.size(); ++i) {
    const bool good = found[i] != 0 && static_cast<double>(residuals[i]) <= config.flow_max_residual &&
                      inside(to[i], destination.gray.size());
    if (good) tracks.push_back({.from = source.corners[i], .to = to[i], .residual = residuals[i]});
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
