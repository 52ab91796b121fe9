#pragma once

#include <string>

#include "core/sequence/bag/messages.hpp"
#include "core/sequence/image_file.hpp"

namespace stillpoint {

/// The image of a message: rgb8, bgr8, rgba8, bgra8, mono8, Bayer patterns and YUV 4:2:2 as 8 bits; 16UC1 and
/// mono16 as 16 bits; 32FC1 as depth in metres, in which NaN, infinity and what is negative become 0.
/// Compressed ones are JPEG, PNG, and compressed_depth_image_transport's PNG.
/// @param path names it in messages
[[nodiscard]] ImageRead image_of(const ImageMessage& message, const std::string& path);

}  // namespace stillpoint
