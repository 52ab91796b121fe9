#include "core/sequence/bag/ros1_records.hpp"

namespace stillpoint::ros1 {
namespace {

constexpr std::uint64_t kLargestHeader = 1 << 20;  // bytes: headers hold a few names, so that more is damage

}  // namespace

RecordState read_record(const RandomFile& file, std::uint64_t at, Record& record) {
  const Bytes start = file.read(at, 4);
  if (start.size() < 4) return RecordState::cut_off;
  const auto header_size = ByteReader(start).number<std::uint32_t>();
  if (header_size > kLargestHeader) return RecordState::damaged;
  record.header = file.read(at + 4, std::uint64_t{header_size} + 4);
  if (record.header.size() < std::size_t{header_size} + 4) return RecordState::cut_off;
  const auto claimed = ByteReader(ByteView(record.header).subspan(header_size)).number<std::uint32_t>();
  record.header.resize(header_size);
  record.at = at;
  record.data = at + 8 + header_size;
  record.is_cut = claimed > file.size() - record.data;
  record.size = record.is_cut ? file.size() - record.data : claimed;
  return RecordState::read;
}

}  // namespace stillpoint::ros1
