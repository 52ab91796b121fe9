#include "core/assets.hpp"

#include <cstdlib>
#include <initializer_list>

/// The tree the library is installed in, of a program that was built with find_package(Stillpoint), whose
/// package compiles this into it; of others there is none.
extern "C" [[gnu::weak]] const char* stillpoint_prefix();

namespace stillpoint {
namespace {

/// `folder` of the installed tree: that of the program, or that of the library. Empty where it is in neither.
std::filesystem::path installed(const char* folder) {
  std::error_code none;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", none);
  const std::filesystem::path library = stillpoint_prefix != nullptr ? stillpoint_prefix() : "";
  for (const auto& prefix : {program.parent_path().parent_path(), library})
    if (!prefix.empty() && std::filesystem::is_directory(prefix / folder, none)) return prefix / folder;
  return {};
}

}  // namespace

std::filesystem::path assets_folder() {
  if (const char* chosen = std::getenv("STILLPOINT_ASSETS")) return chosen;
  const auto beside = installed("share/stillpoint");
  return beside.empty() ? STILLPOINT_SOURCE_ASSETS : beside;
}

std::filesystem::path modules_folder() {
  const auto beside = installed("lib/stillpoint/modules");
  return beside.empty() ? STILLPOINT_BUILT_MODULES : beside;
}

}  // namespace stillpoint
