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

NewFolders::NewFolders(const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::path path = std::filesystem::absolute(folder, failed).lexically_normal();
  if (path.filename().empty()) path = path.parent_path();
  for (; !path.empty() && path != path.root_path() && !std::filesystem::exists(path, failed);
       path = path.parent_path())
    missing_.push_back(path);
}

NewFolders::~NewFolders() {
  std::error_code not_empty;
  for (const std::filesystem::path& folder : missing_)
    if (!std::filesystem::remove(folder, not_empty)) return;
}

void check_out_file(const std::filesystem::path& file, bool force) {
  std::error_code none;
  const std::filesystem::file_status status = std::filesystem::status(file, none);
  if (std::filesystem::is_directory(status))
    throw InputError(fmt::format("{}: is a folder, where a file is wanted", file.string()));
  if (std::filesystem::exists(status) && !force)
    throw InputError(fmt::format("{}: is there already; --force replaces it", file.string()));
  // A device or a pipe is written to as it is, whatever its folder.
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) return;
  const std::filesystem::path whole =
      std::filesystem::is_symlink(file, none) ? std::filesystem::weakly_canonical(file, none) : file;
  const std::filesystem::path folder = whole.has_parent_path() ? whole.parent_path() : ".";
  if (!std::filesystem::is_directory(folder, none))
    throw InputError(fmt::format("{}: there is no folder {}", file.string(), folder.string()));
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw InputError(fmt::format("{}: cannot be written ({})", file.string(), std::strerror(errno)));
}

WholeFile::WholeFile(std::filesystem::path path, std::string_view ending) : path_(std::move(path)) {
  std::error_code none;
  if (std::filesystem::is_symlink(path_, none)) path_ = std::filesystem::weakly_canonical(path_, none);
  const bool is_other =
      std::filesystem::exists(path_, none) && !std::filesystem::is_regular_file(path_, none);
  part_ = path_;
  if (!is_other) (part_ += ".part") += ending;
}

WholeFile::~WholeFile() {
  std::error_code none;
  if (!kept_ && part_ != path_) std::filesystem::remove(part_, none);
}

void WholeFile::keep() {
  std::error_code failed;
  if (part_ != path_) std::filesystem::rename(part_, path_, failed);
  if (failed) throw InputError(fmt::format("{}: cannot be written ({})", path_.string(), failed.message()));
  kept_ = true;
}

void WholeFiles::add(const std::filesystem::path& path, std::string_view text, std::string_view ending) {
  add(
      path, [text](std::ostream& file) { file << text; }, ending);
}

void WholeFiles::add(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write,
                     std::string_view ending) {
  const WholeFile& whole = files_.emplace_back(path, ending);
  errno = 0;
  std::ofstream file(whole.while_written(), std::ios::binary);
  write(file);
  file.close();  // a full disk may show only now
  if (!file)
    throw InputError(
        fmt::format("{}: cannot be written ({})", path.string(), std::strerror(errno != 0 ? errno : EIO)));
}

void WholeFiles::keep() {
  for (WholeFile& file : files_) file.keep();
}

void write_text_file(const std::filesystem::path& path, std::string_view text, std::string_view ending) {
  WholeFiles files;
  files.add(path, text, ending);
  files.keep();
}

}  // namespace stillpoint
