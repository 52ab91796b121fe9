#pragma once

#include <optional>
#include <string>

#include "core/sequence/source.hpp"

namespace stillpoint {

/// Whether a ROS 1 bag's chunks are packed by bzip2, and are many: some ten images a second come out of it,
/// too few to look at. TUM's bags are such.
/// @throws InputError where it cannot be read
[[nodiscard]] bool is_slow_bag(const std::string& path);

/// The same bag with its chunks unpacked, in the cache (archive/cache_folder.hpp): what `rosbag decompress`
/// makes. A cut-off bag stays one.
/// @throws InputError where there is no room for it, and whatever options.progress throws
[[nodiscard]] std::string unpacked_bag(const std::string& path, const OpenOptions& options);

}  // namespace stillpoint
