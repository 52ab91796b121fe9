#pragma once

#include <string>

#include "core/sequence/source.hpp"

namespace stillpoint {

/// A hash of a sequence's content, 16 hex digits, by which a sequence that was changed is noticed: all
/// stamps, the ground truth, and the pixels of the first, the middle and the last frame. It does not depend
/// on where the sequence lies. Reads three frames.
[[nodiscard]] std::string sequence_fingerprint(const FrameSource& source);

}  // namespace stillpoint
