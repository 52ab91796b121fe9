#include "core/export/mcap_writer.hpp"

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>

#include "core/error.hpp"

namespace stillpoint {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie");

constexpr std::string_view kMagic = "\x89MCAP0\r\n";
constexpr std::size_t kChunkBytes = 4 << 20;  // unpacked: a few frames
constexpr int kPackingLevel = 1;              // beside a run: fast
enum Op : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

/// A record's content, piece by piece.
class Content {
 public:
  template <typename Number>
  Content& number(Number value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  Content& bytes(std::string_view value) {
    bytes_.append(value);
    return *this;
  }
  /// With its length before it.
  Content& text(std::string_view value) {
    return number(static_cast<std::uint32_t>(value.size())).bytes(value);
  }
  [[nodiscard]] const std::string& str() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string record(std::uint8_t op, std::string_view content) {
  return Content().number(op).number(static_cast<std::uint64_t>(content.size())).bytes(content).str();
}

std::uint32_t crc_of(std::uint32_t crc, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      ::crc32(crc, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

}  // namespace

McapWriter::McapWriter(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  if (!file_) throw InputError(fmt::format("{}: cannot be written ({})", path, std::strerror(errno)));
  put(kMagic);
  put_record(kHeader, Content().text("").text("stillpoint").str());
}

std::uint16_t McapWriter::add_schema(const std::string& name, const std::string& encoding,
                                     std::string_view data) {
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  schemas_.push_back(record(kSchema, Content().number(id).text(name).text(encoding).text(data).str()));
  put(schemas_.back());
  return id;
}

std::uint16_t McapWriter::add_channel(const std::string& topic, const std::string& encoding,
                                      std::uint16_t schema) {
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
  channels_.push_back(
      record(kChannel, Content().number(id).number(schema).text(topic).text(encoding).text("").str()));
  put(channels_.back());
  return id;
}

void McapWriter::write(std::uint16_t channel, std::uint64_t time_ns, std::string_view message) {
  if (chunk_.empty()) chunk_first_ = chunk_last_ = time_ns;
  if (messages_ == 0) first_ = last_ = time_ns;
  chunk_first_ = std::min(chunk_first_, time_ns), chunk_last_ = std::max(chunk_last_, time_ns);
  first_ = std::min(first_, time_ns), last_ = std::max(last_, time_ns);
  const auto sequence = static_cast<std::uint32_t>(counts_[channel]++);
  ++messages_;
  indexes_[channel].push_back({time_ns, chunk_.size()});
  chunk_ +=
      record(kMessage,
             Content().number(channel).number(sequence).number(time_ns).number(time_ns).bytes(message).str());
  if (chunk_.size() >= kChunkBytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  std::string packed(ZSTD_compressBound(chunk_.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), chunk_.data(), chunk_.size(), kPackingLevel));
  ChunkIndex index;
  index.first = chunk_first_, index.last = chunk_last_;
  index.offset = at_;
  index.packed = packed.size(), index.unpacked = chunk_.size();
  put_record(kChunk, Content()
                         .number(chunk_first_)
                         .number(chunk_last_)
                         .number(static_cast<std::uint64_t>(chunk_.size()))
                         .number(crc_of(0, chunk_))
                         .text("zstd")
                         .number(static_cast<std::uint64_t>(packed.size()))
                         .bytes(packed)
                         .str());
  index.length = at_ - index.offset;
  const std::uint64_t indexes_at = at_;
  for (auto& [channel, entries] : indexes_) {
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Index& a, const Index& b) { return a.time < b.time; });
    index.indexes[channel] = at_;
    Content content;
    content.number(channel).number(static_cast<std::uint32_t>(entries.size() * sizeof(Index)));
    for (const Index& entry : entries) content.number(entry.time).number(entry.offset);
    put_record(kMessageIndex, content.str());
  }
  index.index_length = at_ - indexes_at;
  chunks_.push_back(std::move(index));
  chunk_.clear();
  indexes_.clear();
}

void McapWriter::finish() {
  end_chunk();
  put_record(kDataEnd,
             Content().number(std::uint32_t{0}).str());  // no checksum of the data: chunks have theirs
  const std::uint64_t summary_at = at_;
  in_summary_ = true;
  struct Group {
    std::uint8_t op;
    std::uint64_t begin, length;
  };
  std::vector<Group> groups;
  const auto group = [&](std::uint8_t op, const auto& write_all) {
    const std::uint64_t begin = at_;
    write_all();
    if (at_ > begin) groups.push_back({op, begin, at_ - begin});
  };
  group(kSchema, [&] {
    for (const std::string& schema : schemas_) put(schema);
  });
  group(kChannel, [&] {
    for (const std::string& channel : channels_) put(channel);
  });
  group(kStatistics, [&] {
    Content content;
    content.number(messages_)
        .number(static_cast<std::uint16_t>(schemas_.size()))
        .number(static_cast<std::uint32_t>(channels_.size()))
        .number(std::uint32_t{0})  // attachments
        .number(std::uint32_t{0})  // metadata
        .number(static_cast<std::uint32_t>(chunks_.size()))
        .number(first_)
        .number(last_)
        .number(static_cast<std::uint32_t>(counts_.size() * (sizeof(std::uint16_t) + sizeof(std::uint64_t))));
    for (const auto& [channel, count] : counts_) content.number(channel).number(count);
    put_record(kStatistics, content.str());
  });
  group(kChunkIndex, [&] {
    for (const ChunkIndex& chunk : chunks_) {
      Content content;
      content.number(chunk.first).number(chunk.last).number(chunk.offset).number(chunk.length);
      content.number(
          static_cast<std::uint32_t>(chunk.indexes.size() * (sizeof(std::uint16_t) + sizeof(std::uint64_t))));
      for (const auto& [channel, offset] : chunk.indexes) content.number(channel).number(offset);
      content.number(chunk.index_length).text("zstd").number(chunk.packed).number(chunk.unpacked);
      put_record(kChunkIndex, content.str());
    }
  });
  const std::uint64_t offsets_at = at_;
  for (const Group& of : groups)
    put_record(kSummaryOffset, Content().number(of.op).number(of.begin).number(of.length).str());
  // The checksum covers the summary and the footer up to itself.
  const std::string footer_head = Content()
                                      .number(static_cast<std::uint8_t>(kFooter))
                                      .number(std::uint64_t{8 + 8 + 4})
                                      .number(summary_at)
                                      .number(offsets_at)
                                      .str();
  put(footer_head);
  put(Content().number(summary_crc_).str());
  put(kMagic);
  errno = 0;
  file_.close();
  if (!file_)
    throw InputError(
        fmt::format("{}: cannot be written ({})", path_, std::strerror(errno != 0 ? errno : EIO)));
}

void McapWriter::put(std::string_view bytes) {
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  at_ += bytes.size();
  if (in_summary_) summary_crc_ = crc_of(summary_crc_, bytes);
}

void McapWriter::put_record(std::uint8_t op, std::string_view content) { put(record(op, content)); }

}  // namespace stillpoint
