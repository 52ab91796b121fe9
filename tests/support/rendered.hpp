#pragma once

#include <memory>
#include <string>

#include "core/sequence/source.hpp"

namespace stillpoint {

/// The first frames of `generated:KIND`, each rendered at most once a process: rendering a frame takes longer
/// than most of what is tested on it. Frames share their pixels with all others that are given out, so nobody
/// writes to them.
/// @param frames as make_generated_sequence has it
[[nodiscard]] std::shared_ptr<const FrameSource> rendered(const std::string& kind, int frames,
                                                          unsigned seed = 1);

}  // namespace stillpoint
