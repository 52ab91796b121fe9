#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "core/motion/motion_method.hpp"
#include "core/odometry/engine_trace.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {

/// What a frame gives: the record that is kept, and the motion stage's images, which can be computed again.
struct FrameResult {
  FrameRecord record;
  MotionResult motion;  ///< the method's judgement, as far as it came to one
  cv::Mat mask;         ///< what was removed, CV_8UC1, 255 = dynamic; empty when nothing was
  std::shared_ptr<const EngineTrace> engine{};  ///< what the engine saw; null where the record tells all
};

}  // namespace stillpoint
