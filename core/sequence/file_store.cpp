#include "core/sequence/file_store.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "core/error.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

void check_folder(const std::string& folder) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (status.type() == fs::file_type::not_found)
    throw InputError(fmt::format("{}: there is no such folder", folder));
  if (error) throw InputError(fmt::format("{}: cannot be opened: {}", folder, error.message()));
  if (!fs::is_directory(status))
    throw InputError(fmt::format("{}: is a file, expected a folder in the TUM RGB-D layout", folder));
  const fs::directory_iterator entries(folder, error);
  if (error) throw InputError(fmt::format("{}: cannot be opened: {}", folder, error.message()));
}

class Folder final : public FileStore {
 public:
  explicit Folder(std::string folder) : folder_(std::move(folder)) { check_folder(folder_); }

  [[nodiscard]] const std::string& place() const override { return folder_; }
  [[nodiscard]] std::vector<std::string> own_names() const override {
    fs::path whole = fs::absolute(folder_).lexically_normal();
    if (whole.filename().empty()) whole = whole.parent_path();
    return {whole.filename().string(), whole.parent_path().filename().string()};
  }
  [[nodiscard]] bool is_there(const std::string& name) const override {
    std::error_code none;
    return fs::exists(path_of(name), none);
  }
  [[nodiscard]] bool is_file(const std::string& name) const override {
    std::error_code none;
    return fs::is_regular_file(path_of(name), none);
  }
  [[nodiscard]] bool is_folder(const std::string& name) const override {
    std::error_code none;
    return fs::is_directory(path_of(name), none);
  }
  [[nodiscard]] std::vector<std::string> entries(const std::string& folder) const override {
    std::vector<std::string> names;
    std::error_code failed;
    for (const auto& entry : fs::directory_iterator(path_of(folder), failed))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }
  [[nodiscard]] std::string why_no_bytes(const std::string& name) const override {
    struct stat status {};
    if (::stat(path_of(name).c_str(), &status) != 0)
      return errno == ENOENT || errno == ENOTDIR ? "is missing" : "";
    return S_ISREG(status.st_mode) && status.st_size == 0 ? "is empty (0 bytes)" : "";
  }
  [[nodiscard]] std::string read(const std::string& name, Bytes& bytes) const override {
    return read_bytes(path_of(name), bytes);
  }
  [[nodiscard]] std::string read_text(const std::string& name) const override {
    return stillpoint::read_text(path_of(name));
  }
  [[nodiscard]] std::string path_of(const std::string& name) const override {
    return name.empty() ? folder_ : (fs::path(folder_) / name).string();
  }

 private:
  std::string folder_;
};

}  // namespace

std::unique_ptr<FileStore> open_folder(const std::string& folder) { return std::make_unique<Folder>(folder); }

}  // namespace stillpoint
