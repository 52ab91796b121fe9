#include <fmt/format.h>

#include <map>
#include <set>

#include "core/error.hpp"
#include "core/sequence/bag/chunked_log.hpp"
#include "core/sequence/bag/ros1_records.hpp"

namespace stillpoint {
namespace {

using namespace ros1;

std::int64_t nanoseconds(std::uint32_t seconds, std::uint32_t rest) {
  return std::int64_t{seconds} * 1'000'000'000 + rest;
}

class Ros1Bag final : public ChunkedLog {
 public:
  Ros1Bag(const std::string& file, const std::string& path) : ChunkedLog(file, path) {
    const Bytes magic = file_.read(0, kRos1Magic.size());
    const std::string version = ByteReader::to_text(magic);
    if (version != kRos1Magic)
      throw InputError(version.starts_with("#ROSBAG") || version.starts_with("#ROSRECORD")
                           ? fmt::format("{}: is a bag of an older format, and 2.0 is read (`rosbag fix` "
                                         "writes it anew)",
                                         path)
                           : fmt::format("{}: is no ROS 1 bag", path));
    walk();
    for (const std::uint32_t chunk : unindexed_) scan(chunk, true);
    // Without its end a bag names its connections in its chunks alone, each where its first message is.
    for (const auto& [id, places] : places_by_id_)
      if (!connections_.contains(id) && !places.empty()) scan(places.front().chunk, false);
    std::vector<std::pair<LoggedTopic, std::vector<Place>>> topics;
    std::map<std::string, std::size_t> by_name;
    for (auto& [id, places] : places_by_id_) {
      const auto connection = connections_.find(id);
      if (connection == connections_.end()) {
        warnings_.push_back(
            fmt::format("{}: {} messages belong to no known topic and were left out", path, places.size()));
        continue;
      }
      const auto [at, is_new] = by_name.try_emplace(connection->second.name, topics.size());
      if (is_new) topics.push_back({connection->second, {}});
      auto& all = topics[at->second].second;
      all.insert(all.end(), places.begin(), places.end());
    }
    set_topics(std::move(topics));
  }

 protected:
  [[nodiscard]] std::pair<std::uint64_t, std::uint64_t> message_in(ByteView record) const override {
    ByteReader reader(record);
    reader.counted();
    const auto size = reader.number<std::uint32_t>();
    return {reader.at(), size};
  }

 private:
  void cut_off(std::uint64_t at) {
    warnings_.push_back(
        fmt::format("{}: is cut off after {} bytes; what it holds up to there was read", file_.path(), at));
    scan_last_chunk();
  }

  /// Part of its index may be missing.
  void scan_last_chunk() {
    if (chunks_.empty()) return;
    const auto last = static_cast<std::uint32_t>(chunks_.size()) - 1;
    for (auto& [id, places] : places_by_id_)
      std::erase_if(places, [last](const Place& place) { return place.chunk == last; });
    unindexed_.insert(last);
  }

  /// All records from the first to the last, the chunks' contents passed over. The index that stands at the
  /// end of a bag repeats what stands behind each chunk, so that one way serves whole and cut bags.
  void walk() {
    bool is_whole = false;
    Record record;
    for (std::uint64_t at = kRos1Magic.size(); at < file_.size(); at = record.end()) {
      const RecordState state = read_record(file_, at, record);
      if (state == RecordState::damaged) return damaged(at, "has a record whose header is none");
      if (state == RecordState::cut_off) return cut_off(at);
      try {
        const Fields fields = fields_of(record.header);
        is_whole = is_whole || field<std::uint8_t>(fields, "op") == kChunkInfo;
        take(fields, record.data, record.size, record.is_cut);
      } catch (const MalformedBytes& error) {
        return damaged(at, error.what());
      }
      if (record.is_cut) return cut_off(file_.size());
    }
    if (!is_whole && !chunks_.empty()) cut_off(file_.size());
  }

  void damaged(std::uint64_t at, const std::string& cause) {
    const std::string sentence = fmt::format("{}: is damaged at byte {}: it {}", file_.path(), at, cause);
    if (chunks_.empty()) throw InputError(sentence);
    warnings_.push_back(sentence + "; what it holds up to there was read");
  }

  void take(const Fields& fields, std::uint64_t data, std::uint64_t size, bool is_cut) {
    switch (field<std::uint8_t>(fields, "op")) {
      case kChunk: {
        Chunk chunk{data, size, field<std::uint32_t>(fields, "size"),
                    compression_by_name(text_field(fields, "compression"))};
        if (chunk.unpacked_size > kLargestChunk) throw MalformedBytes("claims a chunk of over a gigabyte");
        if (chunk.compression == Compression::none) chunk.unpacked_size = size;
        add_chunk(chunk);
        unindexed_.insert(static_cast<std::uint32_t>(chunks_.size()) - 1);
        return;
      }
      case kIndex:
        if (is_cut || chunks_.empty()) return;
        read_index(fields, file_.read(data, size));
        unindexed_.erase(static_cast<std::uint32_t>(chunks_.size()) - 1);
        return;
      case kConnection:
        if (!is_cut) read_connection(fields, file_.read(data, size));
        return;
      default:
        return;
    }
  }

  void read_index(const Fields& fields, const Bytes& data) {
    auto& places = places_by_id_[field<std::uint32_t>(fields, "conn")];
    const auto chunk = static_cast<std::uint32_t>(chunks_.size()) - 1;
    ByteReader reader(data);
    while (reader.left() > 0) {
      const auto seconds = reader.number<std::uint32_t>(), rest = reader.number<std::uint32_t>();
      places.push_back({chunk, reader.number<std::uint32_t>(), nanoseconds(seconds, rest)});
    }
  }

  void read_connection(const Fields& fields, ByteView data) {
    const Fields description = fields_of(data);
    const auto id = field<std::uint32_t>(fields, "conn");
    std::string name = text_field(fields, "topic");
    connections_.try_emplace(
        id, LoggedTopic{std::move(name), text_field(description, "type"), WireFormat::ros1, "ros1"});
  }

  /// The records of a chunk that nothing points into, or its connections alone.
  void scan(std::uint32_t chunk, bool with_messages) {
    try {
      const Bytes bytes = chunk_bytes(chunk, 0, kLargestChunk);
      ByteReader reader(bytes);
      while (reader.left() > 0) {
        const std::uint64_t at = reader.at();
        const Fields fields = fields_of(reader.counted());
        const ByteView data = reader.counted();
        const auto op = field<std::uint8_t>(fields, "op");
        if (op == kConnection) read_connection(fields, data);
        if (op != kMessage || !with_messages) continue;
        ByteReader time(field_bytes(fields, "time"));
        const auto seconds = time.number<std::uint32_t>();
        places_by_id_[field<std::uint32_t>(fields, "conn")].push_back(
            {chunk, at, nanoseconds(seconds, time.number<std::uint32_t>())});
      }
    } catch (const MalformedBytes&) {  // it ends within a record, which is what cut_off has told
    }
  }

  std::map<std::uint32_t, LoggedTopic> connections_;
  std::map<std::uint32_t, std::vector<Place>> places_by_id_;
  std::set<std::uint32_t> unindexed_;
};

}  // namespace

std::unique_ptr<MessageLog> open_ros1_bag(const std::string& file, const std::string& path) {
  return std::make_unique<Ros1Bag>(file, path);
}

}  // namespace stillpoint
