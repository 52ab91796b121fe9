#include "tests/support/archive_writer.hpp"

#include <archive.h>
#include <archive_entry.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

namespace stillpoint {

void write_archive(const std::string& path, const std::string& folder, const std::string& kind,
                   const std::string& top) {
  const std::unique_ptr<archive, int (*)(archive*)> writer(archive_write_new(), archive_write_free);
  archive* out = writer.get();
  const auto check = [out](int state) {
    if (state != ARCHIVE_OK) throw std::runtime_error(archive_error_string(out));
  };
  if (kind == "tgz") archive_write_add_filter_gzip(out);
  if (kind == "tar.bz2") archive_write_add_filter_bzip2(out);
  if (kind == "tar.xz") archive_write_add_filter_xz(out);
  if (kind.starts_with("zip")) {
    check(archive_write_set_format_zip(out));
    check(
        archive_write_set_options(out, kind == "zip" ? "zip:compression=deflate" : "zip:compression=store"));
  } else if (kind == "7z") {
    check(archive_write_set_format_7zip(out));
  } else if (kind == "gnutar") {
    check(archive_write_set_format_gnutar(out));
  } else {
    check(archive_write_set_format_pax(out));
  }
  check(archive_write_open_filename(out, path.c_str()));
  std::vector<std::filesystem::path> files;
  for (const auto& file : std::filesystem::recursive_directory_iterator(folder)) files.push_back(file.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    const std::string name = (std::filesystem::path(top) / std::filesystem::relative(file, folder)).string();
    const std::unique_ptr<archive_entry, void (*)(archive_entry*)> entry(archive_entry_new(),
                                                                         archive_entry_free);
    archive_entry_set_pathname(entry.get(), name.c_str());
    archive_entry_set_perm(entry.get(), 0644);
    archive_entry_set_mtime(entry.get(), 1'300'000'000, 123'456'789);
    if (std::filesystem::is_directory(file)) {
      archive_entry_set_filetype(entry.get(), AE_IFDIR);
      check(archive_write_header(out, entry.get()));
      continue;
    }
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(bytes.size()));
    check(archive_write_header(out, entry.get()));
    if (archive_write_data(out, bytes.data(), bytes.size()) != static_cast<la_ssize_t>(bytes.size()))
      throw std::runtime_error(archive_error_string(out));
  }
  check(archive_write_close(out));
}

}  // namespace stillpoint
