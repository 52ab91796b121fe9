#include "core/assets.hpp"

#include <cstdlib>

namespace stillpoint {

std::filesystem::path assets_folder() {
  if (const char* chosen = std::getenv("STILLPOINT_ASSETS")) return chosen;
  std::error_code none;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", none);
  if (!none) {
    auto installed = program.parent_path().parent_path() / "share" / "stillpoint";
    if (std::filesystem::is_directory(installed, none)) return installed;
  }
  return STILLPOINT_SOURCE_ASSETS;
}

std::filesystem::path modules_folder() {
  std::error_code none;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", none);
  if (!none) {
    auto installed = program.parent_path().parent_path() / "lib" / "stillpoint";
    if (std::filesystem::is_directory(installed, none)) return installed;
  }
  return STILLPOINT_BUILT_MODULES;
}

}  // namespace stillpoint
