#pragma once

#include "core/motion/motion_method.hpp"
#include "core/motion/paper/paper_trace.hpp"

namespace stillpoint {

/// What method `paper` saw of a frame.
struct PaperMotionTrace final : MotionTrace {
  PaperTrace pair;
  int reference = -1;      ///< index of the frame it was compared with
  cv::Mat reference_gray;  ///< CV_8UC1
};

/// METHOD.md §1 as it went on one pair of frames, step by step.
/// @param trace null where the frame had none to be compared with
[[nodiscard]] StageLog describe_paper(const Frame& frame, const PaperMotionTrace* trace);

}  // namespace stillpoint
