#include "core/assets.hpp"

#include <cstdlib>
#include <initializer_list>

/// The tree the library is installed in, of a program that was built with find_package(Stillpoint), whose
/// package compiles this into it; of others there is none.
extern "C" [[gnu::weak]] const char* stillpoint_prefix();

namespace stillpoint {
namespace {

/// The installed tree: the program's, else the library's. Empty where neither is installed.
std::filesystem::path installed_tree() {
  std::error_code none;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", none);
  const std::filesystem::path library = stillpoint_prefix != nullptr ? stillpoint_prefix() : "";
  for (const auto& prefix : {program.parent_path().parent_path(), library})
    if (!prefix.empty() && std::filesystem::is_directory(prefix / "share/stillpoint", none)) return prefix;
  return {};
}

}  // namespace

std::filesystem::path assets_folder() {
  if (const char* chosen = std::getenv("STILLPOINT_ASSETS")) return chosen;
  const auto tree = installed_tree();
  return tree.empty() ? std::filesystem::path(STILLPOINT_SOURCE_ASSETS) : tree / "share/stillpoint";
}

std::filesystem::path modules_folder() {
  const auto tree = installed_tree();
  return tree.empty() ? std::filesystem::path(STILLPOINT_BUILT_MODULES) : tree / "lib/stillpoint/modules";
}

}  // namespace stillpoint
