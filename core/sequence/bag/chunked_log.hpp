#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "core/sequence/bag/byte_reader.hpp"
#include "core/sequence/bag/decompress.hpp"
#include "core/sequence/bag/message_log.hpp"
#include "core/sequence/bag/random_file.hpp"

namespace stillpoint {

/// What ROS 1 bags and MCAP files share: messages lie in chunks, packed or not, and an index says which and
/// where in it. The few chunks used last are kept unpacked, so that neighbours and steps back cost nothing.
class ChunkedLog : public MessageLog {
 public:
  [[nodiscard]] const std::string& path() const override { return file_.path(); }
  [[nodiscard]] const std::vector<LoggedTopic>& topics() const override { return topics_; }
  [[nodiscard]] Bytes read(std::size_t topic, std::size_t message, std::size_t most = kWhole) const override;
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }

 protected:
  ChunkedLog(const std::string& file, const std::string& path) : file_(file, path) {}

  struct Chunk {
    std::uint64_t offset = 0;         ///< of its bytes in the file
    std::uint64_t packed_size = 0;    ///< bytes there
    std::uint64_t unpacked_size = 0;  ///< as claimed
    Compression compression = Compression::none;
  };
  struct Place {
    std::uint32_t chunk = 0;
    std::uint64_t offset = 0;  ///< of the message's record in the unpacked chunk
    std::int64_t time = 0;     ///< ns
  };

  /// Bytes of an unpacked chunk from `offset` on, at most `count`; fewer where it ends.
  [[nodiscard]] Bytes chunk_bytes(std::uint32_t chunk, std::uint64_t offset, std::uint64_t count) const;
  /// Where the message's bytes lie in its record. @param record its beginning, kRecordStart bytes of it or
  /// more
  /// @return offset in the record, and size
  [[nodiscard]] virtual std::pair<std::uint64_t, std::uint64_t> message_in(ByteView record) const = 0;
  /// Takes topics and where their messages are, in order of time and name; topics without messages are kept.
  void set_topics(std::vector<std::pair<LoggedTopic, std::vector<Place>>> topics);
  void add_chunk(const Chunk& chunk) { chunks_.push_back(chunk); }

  // Bytes that are read first: a record's head fits, and a small message with it.
  static constexpr std::uint64_t kRecordStart = 512;

  RandomFile file_;
  std::vector<Chunk> chunks_;
  std::vector<std::string> warnings_;

 private:
  using Unpacked = std::shared_ptr<const Bytes>;
  [[nodiscard]] Unpacked unpacked(std::uint32_t chunk, std::uint64_t most) const;

  std::vector<LoggedTopic> topics_;
  std::vector<std::vector<Place>> places_;
  mutable std::mutex mutex_;  ///< guards what is kept
  mutable std::map<std::uint32_t, Unpacked> kept_;
  mutable std::deque<std::uint32_t> order_;  ///< of kept_, oldest first
  mutable std::uint64_t kept_bytes_ = 0;
};

}  // namespace stillpoint
