#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

/// Writes an MCAP file (mcap.dev/spec): messages in chunks packed by zstd, each with an index, and a summary
/// at the end that readers find everything by. Some find nothing in files without chunks.
class McapWriter {
 public:
  /// @throws InputError when the file cannot be made
  explicit McapWriter(const std::string& path);

  /// @param encoding of the schema: "protobuf" (a FileDescriptorSet), "jsonschema"
  [[nodiscard]] std::uint16_t add_schema(const std::string& name, const std::string& encoding,
                                         std::string_view data);
  /// @param encoding of its messages: "protobuf", "json"
  [[nodiscard]] std::uint16_t add_channel(const std::string& topic, const std::string& encoding,
                                          std::uint16_t schema);
  /// @param time_ns since 1970, or whatever the clock counts from
  void write(std::uint16_t channel, std::uint64_t time_ns, std::string_view message);

  /// Ends the file.
  /// @throws InputError when not everything could be written
  void finish();

  [[nodiscard]] std::uint64_t messages() const { return messages_; }

 private:
  struct Index {
    std::uint64_t time = 0, offset = 0;
  };
  struct ChunkIndex {
    std::uint64_t first = 0, last = 0, offset = 0, length = 0, index_length = 0, packed = 0, unpacked = 0;
    std::map<std::uint16_t, std::uint64_t> indexes;  // where each channel's message index begins
  };

  void put(std::string_view bytes);
  void put_record(std::uint8_t op, std::string_view content);
  void end_chunk();

  std::string path_;
  std::ofstream file_;
  std::uint64_t at_ = 0;  // bytes written
  std::vector<std::string> schemas_, channels_;
  std::map<std::uint16_t, std::uint64_t> counts_;
  std::string chunk_;
  std::map<std::uint16_t, std::vector<Index>> indexes_;
  std::vector<ChunkIndex> chunks_;
  std::uint64_t messages_ = 0, first_ = 0, last_ = 0, chunk_first_ = 0, chunk_last_ = 0;
  std::uint32_t summary_crc_ = 0;
  bool in_summary_ = false;
};

}  // namespace stillpoint
