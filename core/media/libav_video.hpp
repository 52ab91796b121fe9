#pragma once

#include <memory>

#include "core/media/media_module.hpp"

namespace stillpoint {

/// Videos by FFmpeg's own libraries: OpenCV's writer neither tags colours nor takes a frame's time.
[[nodiscard]] std::unique_ptr<VideoSink> make_libav_video();

}  // namespace stillpoint
