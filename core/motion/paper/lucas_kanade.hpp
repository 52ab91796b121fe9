#pragma once

#include <atomic>
#include <opencv2/core.hpp>
#include <vector>

#include "core/motion/paper/flow_window.hpp"

namespace stillpoint {

/// Where points went, in the order of the points given.
struct FollowedPoints {
  std::vector<cv::Point2f> to;       ///< px
  std::vector<unsigned char> found;  ///< 0 = lost: `to` means nothing
  std::vector<float> residuals;      ///< mean absolute grey-level difference of the two windows; 0 where lost
};

/// How points are followed.
struct FlowSettings {
  int window_px = 21;           ///< side of the window
  int levels = 3;               ///< pyramid levels above the full image
  int max_steps = 20;           ///< a level
  double least_step_px = 0.03;  ///< a point has arrived when a step is shorter
};

/// What windows around points of an image sum up to, on each level of its pyramid: the same wherever the
/// points are followed to. Who follows them first fills it in, who comes later reads it; threads may share
/// it.
class KnownSums {
 public:
  /// @return null while not all is filled in
  [[nodiscard]] const std::vector<GradientSums>* all() const {
    return state_.load(std::memory_order_acquire) == kFilled ? &sums_ : nullptr;
  }
  /// @return what to fill in before set_filled(); null where somebody else does or did
  [[nodiscard]] std::vector<GradientSums>* to_fill() {
    State empty = kEmpty;
    return state_.compare_exchange_strong(empty, kBeingFilled) ? &sums_ : nullptr;
  }
  void set_filled() { state_.store(kFilled, std::memory_order_release); }

 private:
  enum State { kEmpty, kBeingFilled, kFilled };
  std::atomic<State> state_ = kEmpty;
  std::vector<GradientSums> sums_;  // a point's levels from the full image on, then the next point's
};

/// Pyramidal Lucas-Kanade (Bouguet 2000): what cv::calcOpticalFlowPyrLK computes of the same pyramids, to the
/// last bit with Debian 12's OpenCV. With AVX2 and a window of 21 px it is computed here, in a fraction
/// of the time; elsewhere OpenCV is asked.
/// @param source,destination from cv::buildOpticalFlowPyramid of one window, with derivatives
/// @param points px in `source`
/// @param sums of these very points in `source`, always with the same settings; or null
[[nodiscard]] FollowedPoints follow_points(const std::vector<cv::Mat>& source,
                                           const std::vector<cv::Mat>& destination,
                                           const std::vector<cv::Point2f>& points,
                                           const FlowSettings& settings, KnownSums* sums = nullptr);

}  // namespace stillpoint
