#pragma once

#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/inspect/export_session.hpp"
#include "core/inspect/marks.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

// Truth by hand: a person draws outlines round what moves in some frames, and they are carried to the others
// (mask_carrying.hpp). What comes out is the sequence's true masks from then on.

/// What outlines enclose. @returns CV_8UC1 of that size, 255 = inside any of them
[[nodiscard]] cv::Mat mask_of_outlines(const std::vector<Outline>& movers, cv::Size size);

/// A mask's regions as outlines that can be corrected, the largest first; regions below 60 px are left out.
/// Holes are filled.
[[nodiscard]] std::vector<Outline> outlines_of_mask(const cv::Mat& mask);

/// The frame's own outlines, or null where it has not been drawn.
[[nodiscard]] const DrawnFrame* drawn_at(const std::vector<DrawnFrame>& drawn, int frame);

/// The same with this frame's outlines put in, in place of those it had.
[[nodiscard]] std::vector<DrawnFrame> with_drawn(std::vector<DrawnFrame> drawn, DrawnFrame frame);
[[nodiscard]] std::vector<DrawnFrame> without_drawn(std::vector<DrawnFrame> drawn, int frame);

/// How well carrying from one drawn frame tells what was drawn in the next, or in the one before.
struct CarryingScore {
  int from = 0, to = 0;
  double iou = 0.0;
};

struct CarriedTruth {
  int drawn = 0, carried = 0;              ///< frames with a mask
  std::vector<int> unreadable;             ///< frames without, as their image cannot be read
  std::vector<CarryingScore> scores;       ///< of all neighbours drawn, in which anything moves
  [[nodiscard]] std::string told() const;  ///< of all that, a sentence or two
};

/// The masks of all frames: drawn, or carried from the drawn ones before and after, blended by how far away
/// those are.
/// @param drawn by frame, at least one; frames among the source's
/// @param take given each frame's mask (CV_8UC1, 255 = dynamic), in the order in which they are made
/// @throws InputError where a drawn frame cannot be read, or none is drawn
[[nodiscard]] CarriedTruth carry_drawn(const FrameSource& source, const std::vector<DrawnFrame>& drawn,
                                       const std::function<void(int frame, const cv::Mat& mask)>& take,
                                       const ExportControl& control = {});

/// Whether a folder may take masks: there are none in it, or such as were drawn by hand.
[[nodiscard]] bool may_take_masks(const std::filesystem::path& folder);

/// carry_drawn() into `mask/` and `mask.txt` of a folder, in place of what was drawn there earlier; the list
/// comes last, so that what was there stands until all is written.
/// @returns nothing where it was stopped: the masks are as they were then
/// @throws InputError as carry_drawn, where the folder has masks of another origin, and where it cannot be
/// written
std::optional<CarriedTruth> write_drawn_truth(const FrameSource& source, const std::vector<DrawnFrame>& drawn,
                                              const std::filesystem::path& folder,
                                              const ExportControl& control = {});

}  // namespace stillpoint
