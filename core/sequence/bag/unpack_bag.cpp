#include "core/sequence/bag/unpack_bag.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <future>
#include <vector>

#include "core/error.hpp"
#include "core/sequence/archive/cache_folder.hpp"
#include "core/sequence/bag/decompress.hpp"
#include "core/sequence/bag/ros1_records.hpp"

namespace stillpoint {
namespace {

using namespace ros1;

// Bytes packed by bzip2, which is slow to unpack: from there on one waits for a bag.
constexpr std::uint64_t kMany = 4 << 20;
constexpr std::size_t kAtOnce = 4;  // chunks that are unpacked side by side

template <typename T>
std::string raw(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof(T)};
}

std::string header_field(std::string_view name, std::string_view value) {
  return raw(static_cast<std::uint32_t>(name.size() + 1 + value.size())) + std::string(name) + "=" +
         std::string(value);
}

std::string counted(const std::string& bytes) {
  return raw(static_cast<std::uint32_t>(bytes.size())) + bytes;
}

ByteView view_of(const std::string& text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

class BagUnpacker {
 public:
  BagUnpacker(const std::string& path, const OpenOptions& options)
      : file_(path),
        out_(path, ".bag"),
        options_(options),
        what_(fmt::format("unpacking {} into the cache", std::filesystem::path(path).filename().string())) {}

  std::string unpack() {
    if (const auto found = out_.found()) return *found;
    out_.begin();
    out_.write(view_of(std::string(kRos1Magic)));
    Record record;
    for (std::uint64_t at = kRos1Magic.size(); at < file_.size(); at = record.end()) {
      if (read_record(file_, at, record) != RecordState::read) break;
      if (!take(record) || record.is_cut) break;
      if (options_.progress)
        options_.progress(what_, static_cast<double>(record.end()) / static_cast<double>(file_.size()));
    }
    write_waiting();
    return out_.keep();
  }

 private:
  /// A chunk that is being unpacked, or any other record as it stands.
  struct Waiting {
    std::future<Bytes> chunk;
    std::string other;
  };

  bool take(const Record& record) {
    std::uint8_t op = 0;
    Compression compression = Compression::none;
    std::uint64_t claimed = 0;
    try {
      const Fields fields = fields_of(record.header);
      op = field<std::uint8_t>(fields, "op");
      if (op == kChunk) compression = compression_by_name(text_field(fields, "compression"));
      if (op == kChunk) claimed = field<std::uint32_t>(fields, "size");
    } catch (const MalformedBytes&) {
      return false;
    }
    if (op == kChunk) {
      if (chunks_ == kAtOnce) write_waiting();
      ++chunks_;
      waiting_.push_back({std::async(std::launch::async,
                                     [compression, claimed, packed = file_.read(record.data, record.size)] {
                                       try {
                                         return decompress(compression, packed, claimed);
                                       } catch (const MalformedBytes&) {
                                         return Bytes();
                                       }
                                     }),
                          {}});
      return true;
    }
    if (op == kChunkInfo) {
      // It says where its chunk is, which is elsewhere now; the reader asks only whether the bag has its end.
      waiting_.push_back(
          {{}, counted(header_field("op", std::string(1, static_cast<char>(kChunkInfo)))) + counted("")});
      return true;
    }
    if (record.is_cut) return false;
    const Bytes data = file_.read(record.data, record.size);
    waiting_.push_back(
        {{}, counted(ByteReader::to_text(record.header)) + counted(ByteReader::to_text(data))});
    return true;
  }

  void write_waiting() {
    for (Waiting& waiting : waiting_) {
      if (waiting.chunk.valid()) {
        const Bytes bytes = waiting.chunk.get();
        const auto size = static_cast<std::uint32_t>(bytes.size());
        out_.write(view_of(counted(header_field("op", std::string(1, static_cast<char>(kChunk))) +
                                   header_field("compression", "none") + header_field("size", raw(size))) +
                           raw(size)));
        out_.write(bytes);
      } else {
        out_.write(view_of(waiting.other));
      }
    }
    waiting_.clear();
    chunks_ = 0;
  }

  RandomFile file_;
  UnpackedFile out_;
  const OpenOptions& options_;
  std::string what_;
  std::vector<Waiting> waiting_;
  std::size_t chunks_ = 0;
};

}  // namespace

bool is_slow_bag(const std::string& path) {
  const RandomFile file(path);
  std::uint64_t packed = 0;
  Record record;
  for (std::uint64_t at = kRos1Magic.size(); at < file.size() && packed < kMany; at = record.end()) {
    if (read_record(file, at, record) != RecordState::read) break;
    try {
      if (text_field(fields_of(record.header), "compression") == "bz2") packed += record.size;
    } catch (const MalformedBytes&) {
      break;
    }
  }
  return packed >= kMany;
}

std::string unpacked_bag(const std::string& path, const OpenOptions& options) {
  return BagUnpacker(path, options).unpack();
}

}  // namespace stillpoint
