// What a run leaves: records.bin as it lies, and what stands behind its packing and checksums.
#include <zlib.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "core/odometry/frame_result.hpp"
#include "core/run/records_file.hpp"
#include "tests/fuzz/targets.hpp"

namespace stillpoint::fuzz {
namespace {

using Seeds = std::vector<std::string>;

/// A run of three frames.
RecordedRun example_run() {
  RecordedRun recorded;
  recorded.origin.name = "street", recorded.origin.where = "/street", recorded.origin.frames = 3;
  RunResult& run = recorded.run;
  run.frames_in_sequence = 3;
  for (int i = 0; i < 3; ++i) {
    FrameRecord record;
    record.index = i, record.timestamp = i, record.note = "a note", record.estimated = i > 0;
    record.features.resize(3);
    record.motion_figures.push_back({"figure", 1.5});
    record.removal_check.nothing_removed = Pose::Identity();
    record.direct.seen = std::make_shared<const std::vector<DirectPatch>>(2);
    run.records.push_back(record);
  }
  run.scores.resize(3);
  run.keyframes.resize(1), run.points.resize(2), run.moved.resize(1);
  run.trajectory.resize(2);
  return recorded;
}

void write_example(const std::string& folder) {
  const RecordedRun recorded = example_run();
  RecordsWriter writer(folder, recorded.origin, recorded.run.config);
  for (const FrameRecord& record : recorded.run.records) {
    FrameResult frame;
    frame.record = record;
    if (record.index == 1) frame.mask = cv::Mat::eye(8, 8, CV_8UC1);
    writer.add(frame);
  }
  writer.finish(recorded.run, recorded.run.trajectory);
}

std::string example_file() {
  return written(kRecordsName, [](const std::string&) { write_example(work_folder()); });
}

RecordedRun run_of_file(std::string_view bytes) {
  (void)file_of(bytes, kRecordsName);
  return read_records(work_folder());
}

/// With all that is read only when somebody looks.
void read_file(std::string_view bytes) {
  const RecordedRun recorded = run_of_file(bytes);
  for (std::size_t i = 0; i < recorded.run.records.size(); ++i)
    (void)recorded.record(i), (void)recorded.mask(i);
}
Seeds file_seeds() { return {example_file()}; }

template <typename T>
T taken(std::string_view& bytes) {
  T value{};
  std::memcpy(&value, bytes.data(), std::min(sizeof(T), bytes.size()));
  bytes.remove_prefix(std::min(sizeof(T), bytes.size()));
  return value;
}
template <typename T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// Packs chunks that lie there unpacked, each a kind, a size and bytes: nothing that is changed in these is
/// kept from the reader by a checksum.
/// @param tables where the first table comes to lie
std::string packed_file(std::string_view chunks, std::uint64_t& tables) {
  static const std::string head = example_file().substr(0, kRecordsHeadBytes);
  std::string file = head;
  tables = 0;
  while (!chunks.empty()) {
    if (tables == 0 && chunks.front() == static_cast<char>(ChunkKind::table)) tables = file.size();
    const auto kind = taken<char>(chunks);
    const std::string_view content = chunks.substr(0, taken<std::uint16_t>(chunks));
    chunks.remove_prefix(content.size());
    uLongf length = ::compressBound(content.size());
    std::string packed(length, '\0');
    ::compress2(reinterpret_cast<Bytef*>(packed.data()), &length,
                reinterpret_cast<const Bytef*>(content.data()), content.size(), 0);
    packed.resize(length);
    file += kind;
    put(file, static_cast<std::uint32_t>(packed.size()));
    put(file, static_cast<std::uint32_t>(content.size()));
    put(file, static_cast<std::uint32_t>(
                  ::crc32_z(0, reinterpret_cast<const Bytef*>(packed.data()), packed.size())));
    file += packed;
  }
  return file;
}

/// A whole file, which is opened by its tables. Where these say that frames lie, others do here.
void read_chunks(std::string_view chunks) {
  std::uint64_t tables = 0;
  std::string file = packed_file(chunks, tables);
  const std::vector<std::uint8_t> foot = records_foot(tables);
  file.append(foot.begin(), foot.end());
  (void)run_of_file(file);
}

/// One that lacks what stands behind its chunks, and is read frame by frame.
void read_chunks_of_a_cut_file(std::string_view chunks) {
  std::uint64_t tables = 0;
  read_file(packed_file(chunks, tables));
}

Seeds chunk_seeds() {
  const std::string whole = example_file();
  std::string_view file =
      std::string_view(whole).substr(0, whole.size() - kRecordsFootBytes).substr(kRecordsHeadBytes);
  std::string chunks;
  while (!file.empty()) {
    chunks += taken<char>(file);
    const auto packed = taken<std::uint32_t>(file), unpacked = taken<std::uint32_t>(file);
    (void)taken<std::uint32_t>(file);
    std::string content(unpacked, '\0');
    uLongf length = unpacked;
    ::uncompress(reinterpret_cast<Bytef*>(content.data()), &length,
                 reinterpret_cast<const Bytef*>(file.data()), packed);
    if (chunks.size() == 1) {  // the header, whose config is long
      auto json = nlohmann::json::parse(content);
      json["config"] = "[run]\nmethod = \"paper\"\n";
      content = json.dump();
    }
    put(chunks, static_cast<std::uint16_t>(content.size()));
    chunks += content;
    file.remove_prefix(packed);
  }
  return {chunks};
}

}  // namespace

std::vector<Target> record_targets() {
  // Deflate packs 1032 bytes into one at most; what a chunk holds takes some times as much once it is read.
  constexpr std::size_t kContent = 40;
  return {{"records", {1 << 20, 1032 * kContent}, read_file, file_seeds},
          {"record_chunks", {1 << 20, kContent}, read_chunks, chunk_seeds},
          {"record_frames", {1 << 20, kContent}, read_chunks_of_a_cut_file, chunk_seeds}};
}

}  // namespace stillpoint::fuzz
