#pragma once

#include <vector>

#include "core/motion/motion_stage.hpp"
#include "core/odometry/frame_preparer.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/odometry/local_map.hpp"
#include "core/odometry/tracked_frame.hpp"

namespace stillpoint {

// METHOD.md §1, or what stands in its place: what the motion method says of a frame, written into its result.

/// Has the frame judged. Where the input has a pose, under it.
void judge(const MotionStage& motion, const MotionInput& input, FrameResult& result);

/// What is classified as dynamic before the frame is judged, under the input's pose, becomes the result's
/// mask.
void expect(const MotionStage& motion, const MotionInput& input, FrameResult& result);

/// Takes a judgement back: nothing is removed.
void withdraw(FrameResult& result);

/// All features of the frame, for methods that judge features, as the first pose matched them.
[[nodiscard]] std::vector<MotionFeature> motion_features(const TrackedFrame& first, const LocalMap& map);

}  // namespace stillpoint
