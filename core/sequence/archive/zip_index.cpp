#include <algorithm>

#include "core/sequence/archive/archive_index.hpp"
#include "core/sequence/bag/byte_reader.hpp"

namespace stillpoint {
namespace {

// The format: PKWARE's APPNOTE.TXT.

constexpr std::uint32_t kEndSignature = 0x06054b50, kEnd64Signature = 0x06064b50,
                        kLocatorSignature = 0x07064b50, kEntrySignature = 0x02014b50,
                        kLocalSignature = 0x04034b50;  // as the format has them
// Bytes of the parts that do not vary, and the most of a comment, whose length has 16 bits.
constexpr std::uint64_t kEndSize = 22, kLocatorSize = 20, kLocalSize = 30, kMostComment = 0xFFFF;
constexpr std::uint32_t kIn64 = 0xFFFFFFFF;  // the value stands in the extra field

struct Directory {
  std::uint64_t offset = 0, size = 0;
};

std::optional<Directory> find_directory(const RandomFile& file) {
  const std::uint64_t tail_size = std::min(file.size(), kEndSize + kMostComment);
  const std::uint64_t tail_at = file.size() - tail_size;
  const Bytes tail = file.read(tail_at, tail_size);
  for (std::uint64_t i = tail.size() >= kEndSize ? tail.size() - kEndSize + 1 : 0; i-- > 0;) {
    ByteReader reader(ByteView(tail).subspan(i));
    if (reader.number<std::uint32_t>() != kEndSignature) continue;
    reader.take(8);
    Directory directory;
    directory.size = reader.number<std::uint32_t>();
    directory.offset = reader.number<std::uint32_t>();
    const std::uint64_t end_at = tail_at + i;
    if (end_at >= kLocatorSize) {
      const Bytes bytes = file.read(end_at - kLocatorSize, kLocatorSize);
      ByteReader locator(bytes);
      if (locator.number<std::uint32_t>() == kLocatorSignature) {
        locator.take(4);
        const Bytes end64 = file.read(locator.number<std::uint64_t>(), 56);
        ByteReader record(end64);
        if (record.number<std::uint32_t>() != kEnd64Signature) return std::nullopt;
        record.take(36);
        directory.size = record.number<std::uint64_t>();
        directory.offset = record.number<std::uint64_t>();
      }
    }
    if (directory.offset > file.size() || directory.size > file.size() - directory.offset)
      return std::nullopt;
    return directory;
  }
  return std::nullopt;
}

struct Entry {
  std::string name;
  std::uint16_t method = 0, flags = 0;
  std::uint64_t packed = 0, unpacked = 0, local = 0;
  std::uint32_t checksum = 0;
};

Entry next_entry(ByteReader& reader) {
  Entry entry;
  if (reader.number<std::uint32_t>() != kEntrySignature) throw MalformedBytes("has a directory that is none");
  reader.take(4);
  entry.flags = reader.number<std::uint16_t>();
  entry.method = reader.number<std::uint16_t>();
  reader.take(4);
  entry.checksum = reader.number<std::uint32_t>();
  entry.packed = reader.number<std::uint32_t>();
  entry.unpacked = reader.number<std::uint32_t>();
  const auto name = reader.number<std::uint16_t>(), extra = reader.number<std::uint16_t>(),
             comment = reader.number<std::uint16_t>();
  reader.take(8);
  entry.local = reader.number<std::uint32_t>();
  entry.name = ByteReader::to_text(reader.take(name));
  ByteReader extras(reader.take(extra));
  while (extras.left() >= 4) {
    const auto id = extras.number<std::uint16_t>();
    ByteReader value(extras.take(extras.number<std::uint16_t>()));
    if (id != 1) continue;
    for (std::uint64_t* field : {&entry.unpacked, &entry.packed, &entry.local})
      if (*field == kIn64) *field = value.number<std::uint64_t>();
  }
  reader.take(comment);
  return entry;
}

}  // namespace

std::optional<ArchiveIndex> read_zip_index(const RandomFile& file) try {
  const auto directory = find_directory(file);
  if (!directory) return std::nullopt;
  const Bytes bytes = file.read(directory->offset, directory->size);
  ByteReader reader(bytes);
  ArchiveIndex index;
  while (reader.left() > 0) {
    const Entry entry = next_entry(reader);
    const std::string name = archived_name(entry.name);
    if (name.empty() || entry.name.ends_with('/')) continue;
    constexpr std::uint16_t kStored = 0, kDeflated = 8;  // the format's numbers; other packings are rare
    if ((entry.flags & 1U) != 0 || (entry.method != kStored && entry.method != kDeflated))
      return std::nullopt;
    if (entry.local > file.size() || entry.packed > file.size() - entry.local) return std::nullopt;
    index.files[name] = {entry.local, entry.packed, entry.unpacked, entry.method == kDeflated,
                         entry.checksum};
  }
  // Where the bytes begin is said by the header before them alone, whose extra field may be another.
  for (auto& [name, entry] : index.files) {
    const Bytes local = file.read(entry.offset, kLocalSize);
    ByteReader head(local);
    if (head.number<std::uint32_t>() != kLocalSignature) return std::nullopt;
    head.take(22);
    entry.offset += kLocalSize + head.number<std::uint16_t>();
    entry.offset += head.number<std::uint16_t>();
    if (entry.offset > file.size() || entry.size > file.size() - entry.offset) return std::nullopt;
  }
  return index;
} catch (const MalformedBytes&) {
  return std::nullopt;
}

}  // namespace stillpoint
