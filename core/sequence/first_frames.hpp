#pragma once

#include <memory>

#include "core/sequence/source.hpp"

namespace stillpoint {

/// The first `count` frames of a sequence, or all there are. Ground truth stays whole.
[[nodiscard]] std::unique_ptr<FrameSource> first_frames(std::unique_ptr<FrameSource> source, int count);

}  // namespace stillpoint
