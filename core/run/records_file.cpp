#include "core/run/records_file.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/odometry/engines.hpp"
#include "core/run/run_folder.hpp"
#include "core/run/run_report.hpp"

namespace stillpoint {
namespace {

constexpr std::string_view kMagic = "STILLREC";
constexpr char kHeader = 'H', kFrame = 'F', kEnd = 'E';
constexpr std::uint32_t kMostBytes = 1U << 28U;  // of one chunk unpacked: more is damage
constexpr std::uint64_t kMostPacked = 1032;      // bytes that zlib packs into one, at most
constexpr int kPackingLevel = 1;                 // fast: the run waits for it

std::uint32_t crc_of(const std::vector<std::uint8_t>& bytes) {
  return static_cast<std::uint32_t>(::crc32(0, bytes.data(), static_cast<uInt>(bytes.size())));
}

/// The file ends within a chunk.
struct CutShort {};

/// Reads chunk after chunk, and says what is wrong with the file in a sentence.
class ChunkReader {
 public:
  explicit ChunkReader(const std::filesystem::path& path) : path_(path), file_(path, std::ios::binary) {
    if (!file_) throw InputError(fmt::format("{}: cannot be read ({})", path.string(), std::strerror(errno)));
    std::error_code none;
    bytes_ = std::filesystem::file_size(path, none);
    if (none) bytes_ = 0;
    std::string magic(kMagic.size(), ' ');
    std::uint32_t version = 0;
    file_.read(magic.data(), static_cast<std::streamsize>(magic.size()));
    file_.read(reinterpret_cast<char*>(&version), sizeof(version));
    if (!file_ || magic != kMagic)
      throw InputError(fmt::format("{}: is no file of records written by `stillpoint run`", path.string()));
    if (version != kRecordsVersion)
      throw InputError(
          fmt::format("{}: is of version {}, and this program reads version {}; `stillpoint run … --force` "
                      "writes it anew",
                      path.string(), version, kRecordsVersion));
  }

  /// The next chunk's content, unpacked; its kind goes to `kind`.
  /// @throws CutShort where the file ends before the chunk does
  [[nodiscard]] std::vector<std::uint8_t> next(char& kind) {
    std::uint32_t size = 0, unpacked_size = 0, crc = 0;
    file_.read(&kind, 1);
    for (std::uint32_t* number : {&size, &unpacked_size, &crc})
      file_.read(reinterpret_cast<char*>(number), sizeof(*number));
    if (!file_) throw CutShort();
    if (size > bytes_) throw CutShort();
    if (unpacked_size > kMostBytes || unpacked_size > kMostPacked * size) throw damaged();
    packed_.resize(size);
    file_.read(reinterpret_cast<char*>(packed_.data()), size);
    if (!file_) throw CutShort();
    if (crc_of(packed_) != crc) throw damaged();
    std::vector<std::uint8_t> content(unpacked_size);
    uLongf length = unpacked_size;
    if (::uncompress(content.data(), &length, packed_.data(), size) != Z_OK || length != unpacked_size)
      throw damaged();
    if (kind == kFrame) ++frames_;
    return content;
  }

  [[nodiscard]] std::string cut_short() const {
    return fmt::format("{}: is cut short after {} frames", path_.string(), frames_);
  }
  [[nodiscard]] InputError damaged() const {
    return InputError(fmt::format("{}: is damaged after {} frames", path_.string(), frames_));
  }

 private:
  std::filesystem::path path_;
  std::ifstream file_;
  std::uintmax_t bytes_ = 0;  // of the file: no chunk has more
  std::vector<std::uint8_t> packed_;
  int frames_ = 0;
};

void read_header(const std::vector<std::uint8_t>& content, RecordedRun& recorded) {
  const auto json = parse_json({reinterpret_cast<const char*>(content.data()), content.size()});
  recorded.origin = origin_from_json(json.at("sequence"));
  json.at("frames_in_sequence").get_to(recorded.run.frames_in_sequence);
  recorded.outside = json.value("outside", "");
  recorded.run.config = config_from_toml(json.at("config").get<std::string>(), "its config");
}

void read_frame(const std::vector<std::uint8_t>& content, RecordedRun& recorded) {
  ByteStreamReader from(content);
  recorded.run.records.push_back(read_record(from));
  const std::vector<FrameRecord>& records = recorded.run.records;
  const auto first = static_cast<std::int64_t>(records.front().index);
  if (first < 0 || records.back().index != first + static_cast<std::int64_t>(records.size()) - 1)
    throw ByteStreamReader::Exhausted();
  PackedMask mask;
  from(mask);
  check_mask(mask);  // one that is damaged is told now, not when it is shown
  recorded.masks.push_back(std::move(mask));
}

void read_tail(const std::vector<std::uint8_t>& content, RecordedRun& recorded) {
  ByteStreamReader from(content);
  RunEnd end = read_end(from);
  from(recorded.hash);
  RunResult& run = recorded.run;
  run.scores = std::move(end.scores);
  run.keyframes = std::move(end.keyframes);
  run.points = std::move(end.points);
  run.moved = std::move(end.moved);
  run.trajectory = std::move(end.trajectory);
  run.orb_unit_ms = end.orb_unit_ms;
  run.interrupted = end.interrupted;
  recorded.ground_truth = std::move(end.ground_truth);
}

/// The run as far as its frames tell: poses are those of the moment, and nothing was scored.
void do_without_tail(RecordedRun& recorded, const std::string& cut_short) {
  recorded.cut_short = cut_short + "; what it holds is shown, without map, mask scores and adjusted poses";
  recorded.run.scores.resize(recorded.run.records.size());
  recorded.run.interrupted = true;
  recorded.run.trajectory = recorded.run.live;
  recorded.hash = run_hash(recorded.run.records);
}

}  // namespace

RecordsWriter::RecordsWriter(const std::filesystem::path& run_folder, const SequenceOrigin& origin,
                             const Config& config, const std::string& outside)
    : path_(run_folder / kRecordsName) {
  std::error_code none;
  if (std::filesystem::exists(run_folder / kSummaryName, none)) beside_.emplace(path_);
  file_.open(beside_ ? beside_->while_written() : path_, std::ios::binary);
  if (!file_)
    throw InputError(fmt::format("{}: cannot be written ({})", path_.string(), std::strerror(errno)));
  file_.write(kMagic.data(), static_cast<std::streamsize>(kMagic.size()));
  file_.write(reinterpret_cast<const char*>(&kRecordsVersion), sizeof(kRecordsVersion));
  nlohmann::ordered_json json;
  json["sequence"] = to_json(origin, run_folder);
  json["frames_in_sequence"] = origin.frames;
  json["config"] = to_toml(config);
  if (!outside.empty()) json["outside"] = outside;
  const std::string text = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  for (const char letter : text) content_(letter);
  put_chunk(kHeader);
}

void RecordsWriter::add(const FrameResult& frame) {
  write_record(content_, frame.record);
  content_(pack_mask(frame.mask));
  put_chunk(kFrame);
}

void RecordsWriter::finish(const RunResult& run, const Trajectory& ground_truth) {
  write_end(content_, {run.scores, run.keyframes, run.points, run.moved, run.trajectory, ground_truth,
                       run.orb_unit_ms, run.interrupted});
  content_(run_hash(run.records));
  put_chunk(kEnd);
  errno = 0;
  file_.close();
  if (!file_ && error_ == 0) error_ = errno != 0 ? errno : EIO;
  if (error_ != 0)
    throw InputError(fmt::format("{}: cannot be written ({})", path_.string(), std::strerror(error_)));
}

void RecordsWriter::keep() {
  if (beside_) beside_->keep();
}

void RecordsWriter::discard() {
  file_.close();
  std::error_code none;
  if (!beside_) std::filesystem::remove(path_, none);
  beside_.reset();
}

void RecordsWriter::put_chunk(char kind) {
  const std::vector<std::uint8_t>& content = content_.bytes();
  packed_.resize(::compressBound(static_cast<uLong>(content.size())));
  uLongf length = packed_.size();
  ::compress2(packed_.data(), &length, content.data(), static_cast<uLong>(content.size()), kPackingLevel);
  packed_.resize(length);
  const std::array<std::uint32_t, 3> numbers = {static_cast<std::uint32_t>(length),
                                                static_cast<std::uint32_t>(content.size()), crc_of(packed_)};
  content_.clear();
  if (error_ != 0) return;
  errno = 0;
  file_.put(kind);
  file_.write(reinterpret_cast<const char*>(numbers.data()), sizeof(numbers));
  file_.write(reinterpret_cast<const char*>(packed_.data()), static_cast<std::streamsize>(length));
  file_.flush();
  if (!file_) error_ = errno != 0 ? errno : EIO;
}

std::string run_name(const RecordedRun& recorded) {
  return recorded.outside.empty() ? run_label(recorded.run.config) : recorded.outside;
}

RecordedRun read_records(const std::filesystem::path& run_folder) {
  ChunkReader chunks(run_folder / kRecordsName);
  RecordedRun recorded;
  char kind = 0;
  bool whole = false;
  try {
    const auto header = chunks.next(kind);
    if (kind != kHeader) throw chunks.damaged();
    read_header(header, recorded);
    for (;;) {
      const auto content = chunks.next(kind);
      if (kind == kEnd) {
        read_tail(content, recorded);
        whole = true;
        break;
      }
      if (kind != kFrame) throw chunks.damaged();
      read_frame(content, recorded);
    }
  } catch (const CutShort&) {
    if (recorded.run.records.empty()) throw InputError(chunks.cut_short());
  } catch (const ByteStreamReader::Exhausted&) {
    throw chunks.damaged();
  } catch (const nlohmann::json::exception&) {
    throw chunks.damaged();
  }
  for (const FrameRecord& record : recorded.run.records)
    if (record.estimated) recorded.run.live.push_back({record.timestamp, record.world_from_camera});
  if (!whole) do_without_tail(recorded, chunks.cut_short());
  if (recorded.run.scores.size() != recorded.run.records.size() ||
      run_hash(recorded.run.records) != recorded.hash)
    throw chunks.damaged();
  return recorded;
}

}  // namespace stillpoint
