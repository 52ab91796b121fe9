#pragma once

#include <opencv2/core.hpp>

#include "core/motion/paper/paper_config.hpp"
#include "core/motion/paper/paper_trace.hpp"
#include "core/motion/paper/tracks.hpp"

namespace stillpoint {

/// METHOD.md §1 (Niu & Li 2019, section 1): what is dynamic between two grey frames of one size.
///
/// A pure function of its arguments: same frames and configuration, same bytes, whatever `threads` is.
/// @param reference,target CV_8UC1 of one size
/// @param threads 1 runs the two directions one after the other, 2 or more beside each other
/// @throws InputError when sizes or types differ. Frames smaller than kMinMotionSide give a trace without
/// rounds and a
///         note; a pair without enough texture one round without a mask, and a note.
[[nodiscard]] PaperTrace detect_motion(const cv::Mat& reference, const cv::Mat& target,
                                       const PaperConfig& config, int threads = 1);

/// The same for frames already made ready, with equal results: a sequence prepares each frame once, and keeps
/// it to be the next pair's reference.
/// @param reference,target from prepare_motion_frame with the same `config`
[[nodiscard]] PaperTrace detect_motion(const MotionFrame& reference, const MotionFrame& target,
                                       const PaperConfig& config, int threads = 1);

}  // namespace stillpoint
