#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string_view>

#include "core/error.hpp"
#include "core/sequence/archive/archive_index.hpp"
#include "core/sequence/archive/archive_store.hpp"
#include "core/sequence/archive/cache_folder.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

using Reader = std::unique_ptr<archive, int (*)(archive*)>;

enum class Packing { none, tar, zip, stream, other };

constexpr std::size_t kTarBlock = 512;  // bytes: what a tar's first header fills

Packing packing_of(const RandomFile& file) {
  const Bytes start = file.read(0, kTarBlock);
  const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
  using namespace std::string_view_literals;
  for (const std::string_view magic : {"\x1f\x8b"sv, "BZh"sv, "\xFD\x37zXZ\0"sv, "\x28\xB5\x2F\xFD"sv,
                                       "\x04\x22\x4D\x18"sv, "\x1f\x9d"sv, "LZIP"sv})
    if (text.starts_with(magic)) return Packing::stream;
  if (text.starts_with("PK\3\4"sv) || text.starts_with("PK\5\6"sv)) return Packing::zip;
  for (const std::string_view magic : {"7z\xBC\xAF\x27\x1C"sv, "Rar!"sv})
    if (text.starts_with(magic)) return Packing::other;
  if (text.size() == kTarBlock && text.substr(257, 5) == "ustar") return Packing::tar;
  // Tar of before 1988 has no magic; its name does for one.
  return file.path().ends_with(".tar") ? Packing::tar : Packing::none;
}

void refuse(const std::string& path, archive* reader) {
  const char* cause = archive_error_string(reader);
  throw InputError(
      fmt::format("{}: cannot be unpacked: {}", path, cause != nullptr ? cause : "unknown cause"));
}

Reader open_reader(const std::string& path, bool as_stream) {
  constexpr std::size_t kAtOnce = 1 << 20;  // bytes a read: disks are slow in small pieces
  Reader reader(archive_read_new(), archive_read_free);
  archive_read_support_filter_all(reader.get());
  if (as_stream)
    archive_read_support_format_raw(reader.get());
  else
    archive_read_support_format_all(reader.get());
  if (archive_read_open_filename(reader.get(), path.c_str(), kAtOnce) != ARCHIVE_OK)
    refuse(path, reader.get());
  return reader;
}

/// Tells how far it is, by the packed bytes taken.
class Telling {
 public:
  Telling(const std::string& path, const OpenOptions& options)
      : what_(fmt::format("unpacking {} into the cache", fs::path(path).filename().string())),
        options_(options) {
    std::error_code failed;
    size_ = static_cast<double>(std::max<std::uintmax_t>(1, fs::file_size(path, failed)));
  }
  void tell(archive* reader) const {
    if (options_.progress)
      options_.progress(what_,
                        std::clamp(static_cast<double>(archive_filter_bytes(reader, -1)) / size_, 0.0, 1.0));
  }

 private:
  std::string what_;
  const OpenOptions& options_;
  double size_ = 1;
};

/// Before gigabytes are unpacked of what is no sequence.
void check_start(const std::string& path, std::string_view start) {
  const bool is_tar = start.size() >= kTarBlock && start.substr(257, 5) == "ustar";
  if (is_tar || path.ends_with(".tgz") || path.find(".tar.") != std::string::npos) return;
  for (const char* magic : {"#ROSBAG", "\x89MCAP", "SQLite format 3"})
    if (start.starts_with(magic)) return;
  throw InputError(fmt::format("{}: holds neither an archive nor a bag", path));
}

/// What a compressed file holds, as it is. Where it ends too early, what there is up to there: the archive
/// within tells that it lacks its end.
std::string unpack_stream(const std::string& path, const OpenOptions& options) {
  UnpackedFile file(path, ".unpacked");
  if (const auto found = file.found()) return *found;
  const Reader reader = open_reader(path, true);
  archive_entry* entry = nullptr;
  if (archive_read_next_header(reader.get(), &entry) != ARCHIVE_OK) refuse(path, reader.get());
  file.begin();
  const Telling telling(path, options);
  const void* data = nullptr;
  std::size_t size = 0;
  la_int64_t offset = 0;
  while (archive_read_data_block(reader.get(), &data, &size, &offset) == ARCHIVE_OK) {
    if (file.size() == 0) check_start(path, {static_cast<const char*>(data), size});
    file.write({static_cast<const unsigned char*>(data), size});
    telling.tell(reader.get());
  }
  if (file.size() == 0) refuse(path, reader.get());
  return file.keep();
}

/// The head of a file in a tar archive: ustar's, after GNU's for names that are too long for it.
std::string tar_head(const std::string& name, std::uint64_t size, char type = '0') {
  std::string head;
  if (name.size() > 99 && type == '0') {
    head = tar_head("././@LongLink", name.size() + 1, 'L') + name;
    head.resize((head.size() / kTarBlock + 1) * kTarBlock);
  }
  std::string block(kTarBlock, '\0');
  block.replace(0, std::min<std::size_t>(name.size(), 99), name.substr(0, 99));
  block.replace(100, 8, std::string("0000644\0", 8));
  for (const int at : {108, 116}) block.replace(static_cast<std::size_t>(at), 8, std::string("0000000\0", 8));
  block.replace(124, 12, fmt::format("{:011o}", size) + '\0');
  block.replace(136, 12, std::string("00000000000\0", 12));
  block.replace(148, 8, "        ");
  block[156] = type;
  block.replace(257, 8, std::string("ustar\00000", 8));
  unsigned sum = 0;
  for (const char c : block) sum += static_cast<unsigned char>(c);
  block.replace(148, 8, fmt::format("{:06o}", sum) + std::string("\0 ", 2));
  return head + block;
}

ByteView view_of(const std::string& text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

/// Any other archive, as a tar archive.
std::string unpack_files(const std::string& path, const OpenOptions& options) {
  UnpackedFile file(path, ".unpacked");
  if (const auto found = file.found()) return *found;
  const Reader reader = open_reader(path, false);
  file.begin();
  const Telling telling(path, options);
  archive_entry* entry = nullptr;
  int state = ARCHIVE_OK;
  std::array<unsigned char, 64 << 10> buffer{};
  while ((state = archive_read_next_header(reader.get(), &entry)) == ARCHIVE_OK || state == ARCHIVE_WARN) {
    const char* name = archive_entry_pathname_utf8(entry);
    if (archive_entry_filetype(entry) != AE_IFREG || name == nullptr) continue;
    // Its size may not be known before it was read.
    const std::uint64_t head_at = file.size();
    const std::string unsized = tar_head(name, 0);
    file.write(view_of(unsized));
    const std::uint64_t begin = file.size();
    la_ssize_t got = 0;
    while ((got = archive_read_data(reader.get(), buffer.data(), buffer.size())) > 0) {
      file.write({buffer.data(), static_cast<std::size_t>(got)});
      telling.tell(reader.get());
    }
    const std::uint64_t size = file.size() - begin;
    file.write_at(head_at, view_of(tar_head(name, size)));
    if (size % kTarBlock != 0) file.write(view_of(std::string(kTarBlock - size % kTarBlock, '\0')));
    if (got < 0 && size == 0 && archive_errno(reader.get()) != 0 && begin == unsized.size())
      refuse(path, reader.get());
    if (got == ARCHIVE_FATAL) {
      state = ARCHIVE_FATAL;
      break;
    }
  }
  if (file.size() == 0) refuse(path, reader.get());
  // Without its end it is told to be cut off.
  if (state == ARCHIVE_EOF) file.write(view_of(std::string(2 * kTarBlock, '\0')));
  return file.keep();
}

}  // namespace

bool is_packed(const std::string& path) { return packing_of(RandomFile(path)) != Packing::none; }

Unpacked unpack(const std::string& path, const OpenOptions& options) {
  const RandomFile file(path);
  switch (packing_of(file)) {
    case Packing::stream:
      return {unpack_stream(path, options), true};
    case Packing::zip:
      if (read_zip_index(file)) return {path, false};
      return {unpack_files(path, options), true};
    case Packing::other:
      return {unpack_files(path, options), true};
    case Packing::tar:
    case Packing::none:
      break;
  }
  return {path, false};
}

}  // namespace stillpoint
