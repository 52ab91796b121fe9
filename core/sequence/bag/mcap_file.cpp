#include <fmt/format.h>

#include <map>
#include <set>

#include "core/error.hpp"
#include "core/sequence/bag/chunked_log.hpp"

namespace stillpoint {
namespace {

// The format: mcap.dev/spec. A file is records, each an opcode, a length and bytes.

constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";
constexpr std::uint64_t kRecordHead = 9;  // bytes: opcode and length
// Bytes, at most: two times, the size unpacked, a CRC, the compression's name after its length, the size.
constexpr std::uint64_t kChunkHead = 8 + 8 + 8 + 4 + 4 + 64 + 8;
constexpr std::uint64_t kLargestRecord = 64 << 20;  // bytes, of records that are read whole
enum Op : std::uint8_t {
  kMcapFooter = 2,
  kMcapSchema = 3,
  kMcapChannel = 4,
  kMcapMessage = 5,
  kMcapChunk = 6,
  kMcapMessageIndex = 7
};

struct Channel {
  std::uint16_t schema = 0;
  std::string topic, encoding;
};

class McapFile final : public ChunkedLog {
 public:
  McapFile(const std::string& file, const std::string& path) : ChunkedLog(file, path) {
    if (ByteReader::to_text(file_.read(0, kMcapMagic.size())) != kMcapMagic)
      throw InputError(fmt::format("{}: is no MCAP file", path));
    walk();
    for (const auto& [chunk, ids] : ids_in_)
      for (const std::uint16_t id : ids)
        if (!channels_.contains(id)) unnamed_.insert(chunk);
    for (const std::uint32_t chunk : unindexed_) scan(chunk, true);
    for (const std::uint32_t chunk : unnamed_) scan(chunk, false);
    gather();
  }

 protected:
  [[nodiscard]] std::pair<std::uint64_t, std::uint64_t> message_in(ByteView record) const override {
    ByteReader reader(record);
    reader.take(1);
    const auto size = reader.number<std::uint64_t>();
    constexpr std::uint64_t kHead = 2 + 4 + 8 + 8;  // bytes: channel, sequence number and two times
    if (size < kHead || size > kLargestChunk) throw MalformedBytes("is damaged");
    return {kRecordHead + kHead, size - kHead};
  }

 private:
  /// All records from the first to the last, the chunks' contents passed over: an index stands behind each
  /// chunk, so that one way serves whole and cut files.
  void walk() {
    for (std::uint64_t at = kMcapMagic.size(); at < file_.size();) {
      const Bytes head = file_.read(at, kRecordHead);
      if (head.size() < kRecordHead) return cut_off(at);
      ByteReader reader(head);
      const auto op = reader.number<std::uint8_t>();
      const auto size = reader.number<std::uint64_t>();
      const std::uint64_t data = at + kRecordHead;
      const std::uint64_t there = std::min(size, file_.size() - data);
      try {
        take(op, at, there, there < size);
      } catch (const MalformedBytes& error) {
        return damaged(at, error.what());
      }
      if (there < size) return cut_off(file_.size());
      if (op == kMcapFooter) return;
      at = data + size;
    }
    cut_off(file_.size());
  }

  void cut_off(std::uint64_t at) {
    warnings_.push_back(
        fmt::format("{}: is cut off after {} bytes; what it holds up to there was read", file_.path(), at));
    // Part of the last chunk's index may be missing.
    if (chunks_.empty()) return;
    const auto last = static_cast<std::uint32_t>(chunks_.size()) - 1;
    for (auto& [id, places] : places_by_id_)
      std::erase_if(places, [last](const Place& place) { return place.chunk == last; });
    unindexed_.insert(last);
  }
  void damaged(std::uint64_t at, const std::string& cause) {
    const std::string sentence = fmt::format("{}: is damaged at byte {}: it {}", file_.path(), at, cause);
    if (chunks_.empty()) throw InputError(sentence);
    warnings_.push_back(sentence + "; what it holds up to there was read");
  }

  void take(std::uint8_t op, std::uint64_t at, std::uint64_t size, bool is_cut) {
    const std::uint64_t data = at + kRecordHead;
    if (op == kMcapChunk) return take_chunk(data, size);
    if (op == kMcapMessage) {
      // A message that lies in no chunk is one of its own.
      if (is_cut) return;
      const Bytes head = file_.read(data, 2 + 4 + 8);
      add_chunk({at, size + kRecordHead, size + kRecordHead, Compression::none});
      take_message(head, static_cast<std::uint32_t>(chunks_.size()) - 1, 0);
      return;
    }
    if (is_cut || (op != kMcapSchema && op != kMcapChannel && op != kMcapMessageIndex)) return;
    if (size > kLargestRecord) throw MalformedBytes("claims a record too large");
    const Bytes bytes = file_.read(data, size);
    if (op == kMcapMessageIndex)
      take_index(bytes);
    else
      take_name(op, bytes);
  }

  void take_chunk(std::uint64_t data, std::uint64_t size) {
    const Bytes head = file_.read(data, std::min(size, kChunkHead));
    ByteReader reader(head);
    reader.take(16);
    Chunk chunk;
    chunk.unpacked_size = reader.number<std::uint64_t>();
    reader.take(4);
    chunk.compression = compression_by_name(reader.text());
    chunk.packed_size = reader.number<std::uint64_t>();
    chunk.offset = data + reader.at();
    if (chunk.unpacked_size > kLargestChunk) throw MalformedBytes("claims a chunk of over a gigabyte");
    chunk.packed_size = std::min(chunk.packed_size, data + size - chunk.offset);
    if (chunk.compression == Compression::none) chunk.unpacked_size = chunk.packed_size;
    add_chunk(chunk);
    unindexed_.insert(static_cast<std::uint32_t>(chunks_.size()) - 1);
  }

  void take_index(const Bytes& bytes) {
    if (chunks_.empty()) return;
    const auto chunk = static_cast<std::uint32_t>(chunks_.size()) - 1;
    ByteReader reader(bytes);
    const auto id = reader.number<std::uint16_t>();
    ByteReader entries(reader.counted());
    auto& places = places_by_id_[id];
    while (entries.left() > 0) {
      const auto time = static_cast<std::int64_t>(entries.number<std::uint64_t>());
      places.push_back({chunk, entries.number<std::uint64_t>(), time});
    }
    ids_in_[chunk].insert(id);
    unindexed_.erase(chunk);
  }

  void take_name(std::uint8_t op, ByteView bytes) {
    ByteReader reader(bytes);
    const auto id = reader.number<std::uint16_t>();
    if (op == kMcapSchema) {
      schemas_.try_emplace(id, plain_type(reader.text()));
    } else {
      Channel channel;
      channel.schema = reader.number<std::uint16_t>();
      channel.topic = reader.text();
      channel.encoding = reader.text();
      channels_.try_emplace(id, std::move(channel));
    }
  }

  void take_message(ByteView bytes, std::uint32_t chunk, std::uint64_t offset) {
    ByteReader reader(bytes);
    const auto id = reader.number<std::uint16_t>();
    reader.take(4);
    places_by_id_[id].push_back({chunk, offset, static_cast<std::int64_t>(reader.number<std::uint64_t>())});
  }

  /// The records of a chunk that nothing points into, or whose channels nothing names.
  void scan(std::uint32_t chunk, bool with_messages) {
    try {
      const Bytes bytes = chunk_bytes(chunk, 0, kLargestChunk);
      ByteReader reader(bytes);
      while (reader.left() > 0) {
        const std::uint64_t at = reader.at();
        const auto op = reader.number<std::uint8_t>();
        const ByteView data = reader.take(reader.number<std::uint64_t>());
        if (op == kMcapSchema || op == kMcapChannel) take_name(op, data);
        if (op == kMcapMessage && with_messages) take_message(data, chunk, at);
      }
    } catch (const MalformedBytes&) {  // it ends within a record, which is what cut_off has told
    }
  }

  void gather() {
    std::vector<std::pair<LoggedTopic, std::vector<Place>>> topics;
    std::map<std::string, std::size_t> by_name;
    for (auto& [id, places] : places_by_id_) {
      const auto channel = channels_.find(id);
      if (channel == channels_.end()) {
        warnings_.push_back(fmt::format("{}: {} messages belong to no known topic and were left out",
                                        file_.path(), places.size()));
        continue;
      }
      const auto& [schema, topic, encoding] = channel->second;
      const WireFormat format = encoding == "cdr"    ? WireFormat::cdr
                                : encoding == "ros1" ? WireFormat::ros1
                                                     : WireFormat::other;
      const auto [at, is_new] = by_name.try_emplace(topic, topics.size());
      if (is_new) topics.push_back({{topic, schemas_[schema], format, encoding}, {}});
      auto& all = topics[at->second].second;
      all.insert(all.end(), places.begin(), places.end());
    }
    set_topics(std::move(topics));
  }

  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::map<std::uint16_t, std::vector<Place>> places_by_id_;
  std::map<std::uint32_t, std::set<std::uint16_t>> ids_in_;  ///< channels by chunk
  std::set<std::uint32_t> unindexed_, unnamed_;
};

}  // namespace

std::unique_ptr<MessageLog> open_mcap(const std::string& file, const std::string& path) {
  return std::make_unique<McapFile>(file, path);
}

}  // namespace stillpoint
