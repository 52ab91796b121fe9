#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace stillpoint {

// `records.bin` as chunks, whatever they hold: records_file.hpp has the layout.

inline constexpr std::uint32_t kRecordsVersion = 9;        // raised with every change of the layout
inline constexpr std::uint32_t kOldestRecordsVersion = 8;  ///< had no tables: all frames are read at opening

enum class ChunkKind : char { header = 'H', frame = 'F', table = 'T', end = 'E' };

/// What the file begins with.
[[nodiscard]] std::vector<std::uint8_t> records_head();
/// A chunk as it lies in the file.
[[nodiscard]] std::vector<std::uint8_t> packed_chunk(ChunkKind kind,
                                                     const std::vector<std::uint8_t>& content);
/// What the file ends with, once it is whole.
/// @param tables where the first table lies, bytes from the start
[[nodiscard]] std::vector<std::uint8_t> records_foot(std::uint64_t tables);
// Bytes: magic and version; where the tables lie and magic.
inline constexpr std::uint64_t kRecordsHeadBytes = 12, kRecordsFootBytes = 16;

/// The file ends within a chunk.
struct ChunkCutShort {};
/// A chunk is not what was written.
struct ChunkDamaged {};

/// Reads chunks, from any thread.
class ChunkFile {
 public:
  /// @throws InputError in one sentence for what is missing, no file of records or of another version
  explicit ChunkFile(std::filesystem::path path);

  struct Chunk {
    ChunkKind kind{};
    std::vector<std::uint8_t> content;  ///< unpacked
    std::uint64_t next = 0;             ///< where the one behind it lies
  };
  /// @param at bytes from the start
  /// @throws ChunkCutShort, ChunkDamaged
  [[nodiscard]] Chunk read(std::uint64_t at) const;

  /// Where the first table lies; nothing in a file that is not whole, or too old to have one.
  [[nodiscard]] std::optional<std::uint64_t> tables() const { return tables_; }
  /// Whether the file ends as it should behind the chunks up to `at`.
  /// @throws ChunkCutShort where it ends before that
  [[nodiscard]] bool ends_at(std::uint64_t at) const;

  [[nodiscard]] std::string cut_short(std::size_t frames) const;
  [[nodiscard]] InputError damaged(std::size_t frames) const;

 private:
  [[nodiscard]] bool fetch(std::uint64_t at, void* to, std::size_t bytes) const;

  std::filesystem::path path_;
  std::uint64_t bytes_ = 0;  // of the file: no chunk has more
  std::uint32_t version_ = 0;
  std::optional<std::uint64_t> tables_;
  mutable std::mutex mutex_;  // guards file_
  mutable std::ifstream file_;
};

}  // namespace stillpoint
