#pragma once

#include <cstddef>
#include <vector>

#include "core/motion/stage_log.hpp"

namespace stillpoint {

struct FrameView;

// A frame's whole way, stage by stage: its motion method's stages, then the odometry's, which all methods
// share.

/// The stages the frame went through, in order, with figures held against the round before, and against
/// FrameView::before where there is one.
[[nodiscard]] std::vector<Stage> stages_of(const FrameView& view);

/// Whether a stage is the odometry's.
[[nodiscard]] bool of_odometry(const Stage& stage);

/// The stage to look at first: the one that makes the mask, else the refined pose. 0 of an empty list.
[[nodiscard]] std::size_t telling_stage(const std::vector<Stage>& stages);

}  // namespace stillpoint
