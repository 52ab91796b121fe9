// What a run leaves: records.bin as it lies, and what stands behind its packing and checksums.
#include <zlib.h>

#include <cstring>
#include <nlohmann/json.hpp>

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

constexpr std::size_t kFileHead = 12;  // bytes before the first chunk: the magic and the version

void read_file(std::string_view bytes) {
  (void)file_of(bytes, kRecordsName);
  (void)read_records(work_folder());
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
void read_chunks(std::string_view chunks) {
  static const std::string head = example_file().substr(0, kFileHead);
  std::string file = head;
  while (!chunks.empty()) {
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
  read_file(file);
}
Seeds chunk_seeds() {
  const std::string whole = example_file();
  std::string_view file = std::string_view(whole).substr(kFileHead);
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
          {"record_chunks", {1 << 20, kContent}, read_chunks, chunk_seeds}};
}

}  // namespace stillpoint::fuzz
