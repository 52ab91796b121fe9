#include "tests/fuzz/targets.hpp"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/error.hpp"
#include "core/text_file.hpp"

namespace stillpoint::fuzz {
namespace {

namespace fs = std::filesystem;

struct WorkFolder {
  WorkFolder() {
    std::error_code none;
    const fs::path memory = "/dev/shm";
    const fs::path parent = ::access(memory.c_str(), W_OK) == 0 ? memory : fs::temp_directory_path();
    path = (parent / ("stillpoint_fuzz_" + std::to_string(::getpid()))).string();
    fs::create_directories(path, none);
    ::setenv("XDG_CACHE_HOME", (path + "/cache").c_str(), 1);
  }
  ~WorkFolder() {
    std::error_code none;
    fs::remove_all(path, none);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  std::string path;
};

}  // namespace

const std::vector<Target>& targets() {
  static const std::vector<Target> all = [] {
    std::vector<Target> gathered;
    for (const auto& some :
         {text_targets(), record_targets(), bag_targets(), archive_targets(), image_targets()})
      gathered.insert(gathered.end(), some.begin(), some.end());
    return gathered;
  }();
  return all;
}

bool accepts(const Target& target, std::string_view input) {
  try {
    target.read(input);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

const std::string& work_folder() {
  static const WorkFolder folder;
  return folder.path;
}

std::string file_of(std::string_view bytes, const std::string& name) {
  std::string path = work_folder() + "/" + name;
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return path;
}

std::string written(const std::string& name, const std::function<void(const std::string& path)>& write) {
  const std::string path = work_folder() + "/" + name;
  write(path);
  return read_text(path);
}

}  // namespace stillpoint::fuzz
