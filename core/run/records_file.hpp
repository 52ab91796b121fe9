#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/out_folder.hpp"
#include "core/run/record_chunks.hpp"
#include "core/run/record_codec.hpp"
#include "core/run/sequence_origin.hpp"

namespace stillpoint {

struct FrameResult;

// `records.bin`: what each frame of a run left behind, features and mask included, so that the run can be
// looked at again without being run again.
//
//   8 bytes  "STILLREC"
//   u32      version: kRecordsVersion
//   chunks, each
//     u8     kind: 'H' header, 'F' frame, 'T' table, 'E' end
//     u32    bytes of the content as it lies here
//     u32    bytes of the content once unpacked
//     u32    CRC-32 of the content as it lies here
//     …      the content, packed as zlib packs
//   u64      where the first table lies, bytes from the start
//   8 bytes  "STILLEND"
//
// Numbers are little-endian. The header comes first and is JSON: the sequence (sequence_origin.hpp), the
// config as TOML. Frames follow in order as they are processed: the record (record_codec.cpp has the order of
// its fields), then the mask. Once the run has ended come tables: u32 frames, u64 for each where its chunk
// lies, then their records without features. So a whole file is opened without reading its frames, whose
// features and masks are read when somebody looks. The end is last: map, trajectories, scores, and the run's
// hash. Each chunk is handed to the system at once: a run that is killed leaves its frames, and is read frame
// by frame without what the end would have told. So is version 8, which has neither tables nor what follows
// the end.

inline constexpr const char* kRecordsName = "records.bin";

/// Writes records.bin while a run goes on. A frame that cannot be written, because the disk is full, does not
/// end the run: finish() tells. In a folder that holds a finished run it is written beside that run's, which
/// stays until keep().
class RecordsWriter {
 public:
  /// @throws InputError when the file cannot be made, or another run is being written there
  /// @param outside RecordedRun::outside
  /// @param masks whether that program left masks
  RecordsWriter(const std::filesystem::path& run_folder, const SequenceOrigin& origin, const Config& config,
                const std::string& outside = {}, bool masks = false);

  void add(const FrameResult& frame);

  /// @param run as it ended
  /// @throws InputError when not everything could be written
  void finish(const RunResult& run, const Trajectory& ground_truth);

  /// What was finished takes its name. @throws InputError when it cannot
  void keep();
  /// Takes away what was written.
  void discard();

 private:
  void put_chunk(ChunkKind kind);
  void put(const std::vector<std::uint8_t>& bytes);
  void put_tables(const FrameRecords& records);

  /// Of a file that one run at a time may write.
  class Lock {
   public:
    /// @throws InputError when another has it
    explicit Lock(const std::filesystem::path& path);
    ~Lock();
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

   private:
    int file_;  // descriptor; negative where it could not be opened
  };

  std::filesystem::path path_;
  std::optional<WholeFile> beside_;
  std::optional<Lock> lock_;
  std::ofstream file_;
  ByteStreamWriter content_;
  std::uint64_t end_ = 0;              // of what was written
  std::vector<std::uint64_t> frames_;  // where their chunks lie
  int error_ = 0;                      // errno of the first write that failed
};

/// What a run left of its frames beside their figures: most of its bytes, had when somebody looks.
class FrameDetails {
 public:
  struct Detail {
    std::vector<FeatureRecord> features;
    PackedMask mask;  ///< what was removed
  };
  FrameDetails() = default;
  FrameDetails(const FrameDetails&) = delete;
  FrameDetails& operator=(const FrameDetails&) = delete;
  virtual ~FrameDetails() = default;
  /// Of a record, from any thread. @throws InputError where they cannot be read or are damaged
  [[nodiscard]] virtual Detail of(std::size_t row) const = 0;
};

/// Those that are in memory.
[[nodiscard]] std::shared_ptr<const FrameDetails> details_at_hand(std::vector<FrameDetails::Detail> all);

/// A run as its folder holds it.
struct RecordedRun {
  SequenceOrigin origin;
  RunResult run;                                  ///< records without their features
  std::shared_ptr<const FrameDetails> details{};  ///< one a record; null only without records
  Trajectory ground_truth;                        ///< the sequence's, as it was
  std::string hash;                               ///< run_hash of the records
  std::string outside;    ///< what another program's run is called (outside_run.hpp); empty = ours
  std::string called;     ///< by whoever opened it; empty = as what it is of
  std::string cut_short;  ///< one sentence where the file ends early: what it holds is there without map,
                          ///< scores and adjusted poses; empty when it is whole

  /// A record with its features. @throws as FrameDetails::of does
  [[nodiscard]] FrameRecord record(std::size_t row) const;
  /// What was removed; empty where nothing was. @throws as FrameDetails::of does
  [[nodiscard]] cv::Mat mask(std::size_t row) const;
};

/// What a run is called: as whoever opened it says, by the program that made it, else by method and odometry.
[[nodiscard]] std::string run_name(const RecordedRun& recorded);

/// What is damaged among the frames of a whole file is told when they are looked at; all else at once.
/// @throws InputError in one sentence for a file that is missing, no records file, of another version,
/// damaged, or cut short before its first frame
/// @param on_origin told which sequence it was of as soon as that is known
[[nodiscard]] RecordedRun read_records(const std::filesystem::path& run_folder,
                                       const std::function<void(const SequenceOrigin&)>& on_origin = {});

}  // namespace stillpoint
