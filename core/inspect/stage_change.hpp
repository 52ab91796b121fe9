#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "core/motion/stage_log.hpp"

namespace stillpoint {

struct Camera;
struct FrameView;

// What changed in a stage against the stage, the round or the frame before.

struct StageChange {
  std::string against;  ///< "Frame 12": what the layer is held against
  Layer layer;
  std::string text;  ///< "1,240 px gained, 310 px lost"
};

enum class ChangeAgainst { kStageBefore, kRoundBefore, kFrameBefore };

/// @param stages of the view, as stages_of gives them; `stage` is an index into them
/// @param side which of the stage's sides
/// @returns nothing where there is nothing to hold the stage against
[[nodiscard]] std::optional<StageChange> stage_change(const FrameView& view, const Camera& camera,
                                                      const std::vector<Stage>& stages, std::size_t stage,
                                                      std::size_t side, ChangeAgainst against);

/// MaskChange of every pixel. @param before,after CV_8UC1 of one size; `before` empty = nothing was set
[[nodiscard]] cv::Mat mask_change(const cv::Mat& before, const cv::Mat& after);

}  // namespace stillpoint
