#pragma once

#include <filesystem>

namespace stillpoint {

/// Where presets and cameras are: $STILLPOINT_ASSETS, else beside the installed program, else the source tree
/// the program was built from.
[[nodiscard]] std::filesystem::path assets_folder();

}  // namespace stillpoint
