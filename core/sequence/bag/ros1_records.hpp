#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "core/sequence/bag/byte_reader.hpp"
#include "core/sequence/bag/random_file.hpp"

namespace stillpoint::ros1 {

// The format: wiki.ros.org/Bags/Format/2.0. A file is records, each a header of named fields and data.

inline constexpr std::string_view kRos1Magic = "#ROSBAG V2.0\n";

enum Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

using Fields = std::map<std::string, ByteView, std::less<>>;

/// The fields of a header. All here throw MalformedBytes for what is none.
[[nodiscard]] inline Fields fields_of(ByteView header) {
  Fields fields;
  ByteReader reader(header);
  while (reader.left() > 0) {
    const ByteView field = reader.counted();
    const auto equals = std::find(field.begin(), field.end(), '=');
    if (equals == field.end()) throw MalformedBytes("has a record whose header is none");
    const auto name = static_cast<std::size_t>(equals - field.begin());
    fields[ByteReader::to_text(field.first(name))] = field.subspan(name + 1);
  }
  return fields;
}

[[nodiscard]] inline ByteView field_bytes(const Fields& fields, std::string_view name) {
  const auto found = fields.find(name);
  if (found == fields.end()) throw MalformedBytes(fmt::format("has a record without its field '{}'", name));
  return found->second;
}

template <typename T>
[[nodiscard]] T field(const Fields& fields, std::string_view name) {
  return ByteReader(field_bytes(fields, name)).number<T>();
}

[[nodiscard]] inline std::string text_field(const Fields& fields, std::string_view name) {
  const auto found = fields.find(name);
  return found == fields.end() ? std::string() : ByteReader::to_text(found->second);
}

/// A record of the file, its data not read.
struct Record {
  std::uint64_t at = 0;    ///< of its first byte
  Bytes header;            ///< what fields_of takes
  std::uint64_t data = 0;  ///< offset
  std::uint64_t size = 0;  ///< bytes of data in the file
  bool is_cut = false;     ///< fewer than it claims
  [[nodiscard]] std::uint64_t end() const { return data + size; }
};

enum class RecordState { read, cut_off, damaged };

/// The record that begins at `at`.
[[nodiscard]] RecordState read_record(const RandomFile& file, std::uint64_t at, Record& record);

}  // namespace stillpoint::ros1
