#pragma once

#include <memory>

#include "core/motion/motion_method.hpp"
#include "core/motion/yi2013/block_model.hpp"
#include "core/motion/yi2013/grid_motion.hpp"

namespace stillpoint {

/// What the next frame needs of this one: never changed once it is made, so that copies may share it.
struct Yi2013State {
  int index = -1;
  int frames = 0;                ///< since the model began
  std::vector<cv::Mat> pyramid;  ///< of the filtered frame, which is its first level
  Yi2013Model model;
};

/// What method `yi2013` saw of a frame.
struct Yi2013Trace final : MotionTrace {
  std::shared_ptr<const Yi2013State> last, after;  ///< `last` is null where the model begins
  Yi2013Motion motion;
  Yi2013Model chosen;  ///< the last model in this frame's pixels, before this frame went into it
  cv::Mat matches, mask;
  double ms_motion = 0.0, ms_warp = 0.0, ms_update = 0.0, ms_mask = 0.0;
};

/// Share of the blocks that belong to a Gaussian, 0 to 1. @param matches CV_8UC1 of Yi2013Match
[[nodiscard]] double yi2013_share(const cv::Mat& matches, Yi2013Match match);

/// The stages of method `yi2013`: the camera's motion, the background model, detection.
[[nodiscard]] StageLog describe_yi2013(const Frame& frame, const Yi2013Trace& trace,
                                       const Yi2013Config& config);

}  // namespace stillpoint
