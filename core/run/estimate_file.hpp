#pragma once

#include <optional>
#include <string>

#include "core/geometry/trajectory_file.hpp"

namespace stillpoint {

/// An estimated trajectory in any format of read_trajectory_file, or in a zip that evo saved as its results:
/// the estimate named in its info.json, or the one trajectory in it.
/// @throws InputError as read_trajectory_file does, and for an archive in which no estimate is found
[[nodiscard]] TrajectoryFile read_estimate_file(const std::string& path,
                                                std::optional<QuaternionOrder> order = {});

}  // namespace stillpoint
