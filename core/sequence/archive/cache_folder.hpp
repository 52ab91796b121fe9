#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/sequence/bag/byte_reader.hpp"

namespace stillpoint {

/// What was unpacked once and is kept for the next time. It lies in `$XDG_CACHE_HOME/stillpoint`, otherwise
/// `~/.cache/stillpoint`, and may be deleted whenever one likes. A file's name holds the name, the size and
/// the time of what it was made of, so that another file is never taken for it. A file is written beside its
/// name and renamed when it is whole; what a killed program left half written goes away the next time. All of
/// it together stays below `$STILLPOINT_CACHE_GB` (20): what was not used for longest goes first.
class UnpackedFile {
 public:
  /// @param original the file that is unpacked; @param ending of the unpacked one, ".tar"
  /// @throws InputError where the original is gone
  UnpackedFile(const std::string& original, const std::string& ending);
  ~UnpackedFile();
  UnpackedFile(const UnpackedFile&) = delete;
  UnpackedFile& operator=(const UnpackedFile&) = delete;

  /// Where it is, when it was unpacked before.
  [[nodiscard]] std::optional<std::string> found() const;

  /// Begins to write it. @throws InputError where there is no folder to write to
  void begin();
  /// @throws InputError on a full disk, and beyond what the cache may hold
  void write(ByteView bytes);
  /// Puts bytes in place of those written before. @throws as write does
  void write_at(std::uint64_t offset, ByteView bytes);
  [[nodiscard]] std::uint64_t size() const { return written_; }
  /// It is whole. @return where it is
  [[nodiscard]] std::string keep();

 private:
  void make_room(std::uint64_t bytes);
  void fail(int cause) const;

  std::string original_;
  std::filesystem::path folder_, path_, part_;
  int file_ = -1;
  std::uint64_t written_ = 0, room_ = 0, limit_ = 0;
};

/// The cache's folder. @throws InputError where neither XDG_CACHE_HOME nor HOME is set
[[nodiscard]] std::filesystem::path cache_folder();

}  // namespace stillpoint
