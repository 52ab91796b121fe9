#include "core/run/records_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/run/run_folder.hpp"
#include "core/run/run_report.hpp"

namespace stillpoint {

RecordsWriter::Lock::Lock(const std::filesystem::path& path)
    : file_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  // Disks that know no locks say something else, and are written to all the same.
  if (file_ < 0 || ::flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(file_);
  throw InputError(fmt::format("{}: another run is being written there", path.parent_path().string()));
}

RecordsWriter::Lock::~Lock() {
  if (file_ >= 0) ::close(file_);
}

RecordsWriter::RecordsWriter(const std::filesystem::path& run_folder, const SequenceOrigin& origin,
                             const Config& config, const std::string& outside, bool masks)
    : path_(run_folder / kRecordsName) {
  std::error_code none;
  if (std::filesystem::exists(run_folder / kSummaryName, none)) beside_.emplace(path_);
  const std::filesystem::path written = beside_ ? beside_->while_written() : path_;
  lock_.emplace(written);
  file_.open(written, std::ios::binary);
  if (!file_)
    throw InputError(fmt::format("{}: cannot be written ({})", path_.string(), std::strerror(errno)));
  put(records_head());
  nlohmann::ordered_json json;
  json["sequence"] = to_json(origin, run_folder);
  json["frames_in_sequence"] = origin.frames;
  json["config"] = to_toml(config);
  if (!outside.empty()) {
    json["outside"] = outside;
    json["outside_masks"] = masks;
  }
  const std::string text = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  for (const char letter : text) content_(letter);
  put_chunk(ChunkKind::header);
}

void RecordsWriter::add(const FrameResult& frame) {
  write_record(content_, frame.record);
  content_(pack_mask(frame.mask));
  frames_.push_back(end_);
  put_chunk(ChunkKind::frame);
}

void RecordsWriter::finish(const RunResult& run, const Trajectory& ground_truth) {
  const std::uint64_t tables = end_;
  put_tables(run.records);
  write_end(content_, run, ground_truth);
  content_(run_hash(run.records));
  put_chunk(ChunkKind::end);
  put(records_foot(tables));
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

void RecordsWriter::put_tables(const FrameRecords& records) {
  constexpr std::size_t kFramesATable = 1024;  // what is unpacked at once
  auto record = records.begin();
  for (std::size_t first = 0; first < records.size(); first += kFramesATable) {
    const std::size_t last = std::min(first + kFramesATable, records.size());
    content_(static_cast<std::uint32_t>(last - first));
    for (std::size_t i = first; i < last; ++i) content_(frames_.at(i));
    for (std::size_t i = first; i < last; ++i, ++record) write_record_figures(content_, *record);
    put_chunk(ChunkKind::table);
  }
}

void RecordsWriter::put_chunk(ChunkKind kind) {
  put(packed_chunk(kind, content_.bytes()));
  content_.clear();
}

void RecordsWriter::put(const std::vector<std::uint8_t>& bytes) {
  end_ += bytes.size();
  if (error_ != 0) return;
  errno = 0;
  file_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file_.flush();
  if (!file_) error_ = errno != 0 ? errno : EIO;
}

}  // namespace stillpoint
