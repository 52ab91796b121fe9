#include <algorithm>
#include <future>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/json_text.hpp"
#include "core/odometry/engines.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/outside_run.hpp"
#include "core/run/records_file.hpp"
#include "core/run/run_report.hpp"

namespace stillpoint {
namespace {

using Chunk = ChunkFile::Chunk;
using Exhausted = ByteStreamReader::Exhausted;

/// @param masks whether another program's run left masks; nothing in a file that does not say
void read_header(const Chunk& chunk, RecordedRun& recorded, std::optional<bool>& masks) {
  if (chunk.kind != ChunkKind::header) throw ChunkDamaged();
  const std::vector<std::uint8_t>& content = chunk.content;
  const auto json = parse_json({reinterpret_cast<const char*>(content.data()), content.size()});
  recorded.origin = origin_from_json(json.at("sequence"));
  json.at("frames_in_sequence").get_to(recorded.run.frames_in_sequence);
  recorded.outside = json.value("outside", "");
  if (json.contains("outside_masks")) masks = json["outside_masks"].get<bool>();
  recorded.run.config = config_from_toml(json.at("config").get<std::string>(), "its config");
}

FrameRecord read_frame(const Chunk& chunk, PackedMask& mask) {
  if (chunk.kind != ChunkKind::frame) throw ChunkDamaged();
  ByteStreamReader from(chunk.content);
  FrameRecord record = read_record(from);
  from(mask);
  check_mask(mask);  // one that is damaged is told now, not when it is unpacked
  return record;
}

/// The details of frames that lie in a file.
class DetailsInFile final : public FrameDetails {
 public:
  DetailsInFile(std::shared_ptr<const ChunkFile> file, std::vector<std::uint64_t> places, int first)
      : file_(std::move(file)), places_(std::move(places)), first_(first) {}

  [[nodiscard]] Detail of(std::size_t row) const override {
    try {
      Detail detail;
      FrameRecord record = read_frame(file_->read(places_.at(row)), detail.mask);
      if (record.index != first_ + static_cast<int>(row)) throw ChunkDamaged();
      detail.features = std::move(record.features);
      return detail;
    } catch (const ChunkDamaged&) {
    } catch (const ChunkCutShort&) {
    } catch (const Exhausted&) {
    }
    throw file_->damaged(row);
  }

 private:
  std::shared_ptr<const ChunkFile> file_;
  std::vector<std::uint64_t> places_;  // of their chunks
  int first_;                          // index of the first record
};

class DetailsAtHand final : public FrameDetails {
 public:
  explicit DetailsAtHand(std::vector<Detail> all) : all_(std::move(all)) {}
  [[nodiscard]] Detail of(std::size_t row) const override { return all_.at(row); }

 private:
  std::vector<Detail> all_;
};

struct RecordTable {
  std::vector<std::uint64_t> places;
  std::vector<FrameRecord> records;
};

RecordTable read_table(const std::vector<std::uint8_t>& content) {
  ByteStreamReader from(content);
  RecordTable table;
  table.places.resize(from.count(sizeof(std::uint64_t)));
  for (std::uint64_t& place : table.places) from(place);
  table.records.reserve(table.places.size());
  for (std::size_t i = 0; i < table.places.size(); ++i) table.records.push_back(read_record_figures(from));
  return table;
}

/// What is at hand of a file while it is read.
struct RecordsReading {
  std::shared_ptr<const ChunkFile> file;
  RecordedRun recorded{};
  std::vector<std::uint64_t> places{};  // of the frames' chunks
  std::int64_t first = 0;               // index of the first of them

  void add(FrameRecord record, std::uint64_t place) {
    if (places.empty()) first = record.index;
    if (first < 0 || record.index != first + static_cast<std::int64_t>(places.size())) throw ChunkDamaged();
    recorded.run.records.push_back(std::move(record));
    places.push_back(place);
  }
  void add(RecordTable table) {
    for (std::size_t i = 0; i < table.records.size(); ++i) add(std::move(table.records[i]), table.places[i]);
  }
};

void read_tail(const Chunk& chunk, RecordedRun& recorded) {
  if (chunk.kind != ChunkKind::end) throw ChunkDamaged();
  ByteStreamReader from(chunk.content);
  RunEnd end = read_end(from);
  from(recorded.hash);
  RunResult& run = recorded.run;
  run.scores = ScoreList(std::move(end.scores));
  run.keyframes = std::move(end.keyframes);
  run.points = std::move(end.points);
  run.moved = std::move(end.moved);
  run.trajectory = std::move(end.trajectory);
  run.orb_unit_ms = end.orb_unit_ms;
  run.interrupted = end.interrupted;
  recorded.ground_truth = std::move(end.ground_truth);
}

/// A whole file: its tables, each taken apart while the next is had from the disk, and its end.
void read_tables(std::uint64_t at, RecordsReading& reading) {
  std::future<RecordTable> before;
  const auto take = [&] {
    if (before.valid()) reading.add(before.get());
  };
  for (;;) {
    Chunk chunk = reading.file->read(at);
    take();
    if (chunk.kind != ChunkKind::table) {
      read_tail(chunk, reading.recorded);
      if (!reading.file->ends_at(chunk.next)) throw ChunkDamaged();
      return;
    }
    at = chunk.next;
    before =
        std::async(std::launch::async, [content = std::move(chunk.content)] { return read_table(content); });
  }
}

/// A file that was cut short, or is too old for tables: frame by frame. @returns whether it is whole
bool read_frames(std::uint64_t at, RecordsReading& reading) {
  try {
    for (;;) {
      const Chunk chunk = reading.file->read(at);
      if (chunk.kind == ChunkKind::end) {
        if (!reading.file->ends_at(chunk.next)) throw ChunkDamaged();
        read_tail(chunk, reading.recorded);
        return true;
      }
      // Features are read again when somebody looks.
      PackedMask mask;
      if (chunk.kind != ChunkKind::table) {
        FrameRecord record = read_frame(chunk, mask);
        record.features = std::vector<FeatureRecord>();
        reading.add(std::move(record), at);
      }
      at = chunk.next;
    }
  } catch (const ChunkCutShort&) {
    return false;
  }
}

/// What the records tell of: what their engine does, or what another program left.
void tell_parts(RecordedRun& recorded, const std::optional<bool>& masks) {
  FrameRecords& records = recorded.run.records;
  if (recorded.outside.empty()) {
    const RecordParts measured = engine_of(recorded.run.config).measures;
    for (std::size_t i = 0; i < records.size(); ++i)
      records.change(i, [&measured](FrameRecord& record) { record.measured = measured; });
    return;
  }
  const bool any = masks.value_or(std::any_of(records.begin(), records.end(), [](const FrameRecord& record) {
    return record.mask_share > 0.0 || !record.mask_problem.empty();
  }));
  for (std::size_t i = 0; i < records.size(); ++i)
    records.change(
        i, [any](FrameRecord& record) { tell_parts_of_outside(record, any && record.mask_problem.empty()); });
}

/// The run as far as its frames tell: poses are those of the moment, and nothing was scored.
void do_without_tail(RecordedRun& recorded, const std::string& cut_short) {
  recorded.cut_short = cut_short + "; what it holds is shown, without map, mask scores and adjusted poses";
  recorded.run.scores.resize(recorded.run.records.size());
  recorded.run.interrupted = true;
  recorded.run.trajectory = recorded.run.live;
  recorded.hash = run_hash(recorded.run.records);
}

/// @throws ChunkDamaged, Exhausted and what JSON throws where it is damaged
void read_all_of(RecordsReading& reading, const std::function<void(const SequenceOrigin&)>& on_origin) {
  RecordedRun& recorded = reading.recorded;
  const ChunkFile& file = *reading.file;
  bool whole = false;
  std::optional<bool> masks;
  try {
    const Chunk header = file.read(kRecordsHeadBytes);
    read_header(header, recorded, masks);
    if (on_origin) on_origin(recorded.origin);
    if (file.tables()) read_tables(*file.tables(), reading);
    whole = file.tables() || read_frames(header.next, reading);
  } catch (const ChunkCutShort&) {
    // A file that has its foot is whole, or it is damaged.
    if (file.tables()) throw ChunkDamaged();
  }
  if (!whole && recorded.run.records.empty()) throw InputError(file.cut_short(0));
  tell_parts(recorded, masks);
  for (const FrameRecord& record : recorded.run.records)
    if (record.estimated) recorded.run.live.push_back({record.timestamp, record.world_from_camera});
  if (!whole) do_without_tail(recorded, file.cut_short(recorded.run.records.size()));
  if (recorded.run.scores.size() != recorded.run.records.size() ||
      run_hash(recorded.run.records) != recorded.hash)
    throw ChunkDamaged();
  if (!recorded.run.records.empty())
    recorded.details = std::make_shared<DetailsInFile>(reading.file, std::move(reading.places),
                                                       static_cast<int>(reading.first));
}

}  // namespace

std::shared_ptr<const FrameDetails> details_at_hand(std::vector<FrameDetails::Detail> all) {
  return std::make_shared<DetailsAtHand>(std::move(all));
}

FrameRecord RecordedRun::record(std::size_t row) const {
  FrameRecord record = run.records.at(row);
  record.features = details->of(row).features;
  if (!record.measured.solving)
    for (FeatureRecord& feature : record.features)
      feature.residual_px = std::numeric_limits<float>::quiet_NaN();
  return record;
}

cv::Mat RecordedRun::mask(std::size_t row) const { return unpack_mask(details->of(row).mask); }

std::string run_name(const RecordedRun& recorded) {
  if (!recorded.called.empty()) return recorded.called;
  return recorded.outside.empty() ? run_label(recorded.run.config) : recorded.outside;
}

RecordedRun read_records(const std::filesystem::path& run_folder,
                         const std::function<void(const SequenceOrigin&)>& on_origin) {
  RecordsReading reading{std::make_shared<const ChunkFile>(run_folder / kRecordsName)};
  const auto damaged = [&reading] { return reading.file->damaged(reading.recorded.run.records.size()); };
  try {
    read_all_of(reading, on_origin);
  } catch (const ChunkDamaged&) {
    throw damaged();
  } catch (const Exhausted&) {
    throw damaged();
  } catch (const nlohmann::json::exception&) {
    throw damaged();
  }
  return std::move(reading.recorded);
}

}  // namespace stillpoint
