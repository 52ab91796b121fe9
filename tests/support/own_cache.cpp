#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace {

/// Tests unpack into a cache of their own, which goes away with them.
struct OwnCache {
  OwnCache()
      : folder(std::filesystem::temp_directory_path() / ("stillpoint_cache_" + std::to_string(::getpid()))) {
    ::setenv("XDG_CACHE_HOME", folder.c_str(), 1);
  }
  ~OwnCache() {
    std::error_code none;
    std::filesystem::remove_all(folder, none);
  }
  OwnCache(const OwnCache&) = delete;
  OwnCache& operator=(const OwnCache&) = delete;

  std::filesystem::path folder;
};

const OwnCache own_cache;

}  // namespace
