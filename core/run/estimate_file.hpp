#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/geometry/trajectory_file.hpp"

namespace stillpoint {

/// The trajectory that a program left in a folder, by the names that programs of the field give it.
/// @throws InputError where there is none
[[nodiscard]] std::string trajectory_in(const std::filesystem::path& folder);

/// An estimated trajectory in any format of read_trajectory_file, the one in a folder (trajectory_in), or in
/// a zip that evo saved as its results: the estimate named in its info.json, or the one trajectory in it.
/// @throws InputError as read_trajectory_file does, and for an archive in which no estimate is found
[[nodiscard]] TrajectoryFile read_estimate_file(const std::string& path,
                                                std::optional<QuaternionOrder> order = {});

}  // namespace stillpoint
