#pragma once

#include <filesystem>

namespace stillpoint {

/// Where presets and cameras are: $STILLPOINT_ASSETS, else beside the installed program, else in the
/// installed tree of the library it was built with, else the source tree.
[[nodiscard]] std::filesystem::path assets_folder();

/// Where modules are that are loaded at need: beside the installed program or library, else in the build
/// tree.
[[nodiscard]] std::filesystem::path modules_folder();

}  // namespace stillpoint
