#pragma once

#include <opencv2/core.hpp>

#include "core/config.hpp"
#include "core/motion/motion_trace.hpp"

namespace stillpoint {

/// METHOD.md §1 (Niu & Li 2019, section 1): what moves between two grey frames of one size.
///
/// A pure function of its arguments: same frames and configuration, same bytes, whatever `threads` is.
/// @param reference,target CV_8UC1 of one size, any size of at least 32x32
/// @param threads 1 runs the two directions one after the other, 2 or more beside each other
/// @throws InputError when sizes or types differ. A pair without enough texture gives a trace without a mask, and
///         a note.
[[nodiscard]] MotionTrace detect_motion(const cv::Mat& reference, const cv::Mat& target, const MotionConfig& config,
                                        int threads = 1);

}  // namespace stillpoint
