#include "core/out_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "core/error.hpp"

namespace stillpoint {

void prepare_out_folder(const std::filesystem::path& folder, std::initializer_list<std::string_view> signs,
                        bool force) {
  std::error_code failed;
  if (std::filesystem::exists(folder, failed) && !std::filesystem::is_directory(folder, failed))
    throw InputError(fmt::format("{}: is a file, where a folder for the results is wanted", folder.string()));
  for (const std::string_view sign : signs)
    if (!force && std::filesystem::exists(folder / sign, failed))
      throw InputError(
          fmt::format("{}: holds earlier results ({}); --force overwrites them", folder.string(), sign));
  std::filesystem::create_directories(folder, failed);
  if (failed)
    throw InputError(fmt::format("{}: the folder cannot be made ({})", folder.string(), failed.message()));
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw InputError(
        fmt::format("{}: the folder cannot be written to ({})", folder.string(), std::strerror(errno)));
}

void write_text_file(const std::filesystem::path& path, std::string_view text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw InputError(fmt::format("{}: cannot be written ({})", path.string(), std::strerror(errno)));
}

}  // namespace stillpoint
