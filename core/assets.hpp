#pragma once

#include <filesystem>

namespace stillpoint {

/// Where presets and cameras are: $STILLPOINT_ASSETS, else beside the installed program, else the source tree
/// the program was built from.
[[nodiscard]] std::filesystem::path assets_folder();

/// Where modules are that are loaded at need: beside the installed program, else in the build tree.
[[nodiscard]] std::filesystem::path modules_folder();

}  // namespace stillpoint
