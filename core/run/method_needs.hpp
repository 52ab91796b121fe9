#pragma once

#include <string>

#include "core/config.hpp"

namespace stillpoint {

class FrameSource;

/// Why a config's method cannot do its work over a sequence for want of masks, the true ones or those made
/// elsewhere, in a sentence; "" where it can. Without them it would remove nothing under its own name.
[[nodiscard]] std::string why_no_masks(const Config& config, const FrameSource& source);

/// Its two halves. @param where what the sequence is called
[[nodiscard]] std::string why_no_outside_masks(const Config& config);
[[nodiscard]] std::string why_no_true_masks(const FrameSource& source, const std::string& where);

/// Why none of the masks that a config names is of use to a sequence: none belongs to one of its frames, is
/// of their size and holds what can be taken out. Frames are read until one has a mask, all where none has.
/// "" where one has, or none are named.
[[nodiscard]] std::string why_no_mask_fits(const Config& config, const FrameSource& source);

}  // namespace stillpoint
