#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "core/out_folder.hpp"
#include "core/run/record_codec.hpp"
#include "core/run/sequence_origin.hpp"

namespace stillpoint {

// `records.bin`: what each frame of a run left behind, features and mask included, so that the run can be
// looked at again without being run again.
//
//   8 bytes  "STILLREC"
//   u32      version: kRecordsVersion
//   chunks, each
//     u8     kind: 'H' header, 'F' frame, 'E' end
//     u32    bytes of the content as it lies here
//     u32    bytes of the content once unpacked
//     u32    CRC-32 of the content as it lies here
//     …      the content, packed by zlib
//
// Numbers are little-endian. The header comes first and is JSON: the sequence (sequence_origin.hpp), the
// config as TOML. Frames follow in order as they are processed: the record (record_codec.cpp has the order of
// its fields), then the mask. The end comes once the run has ended: map, trajectories, scores, and, last, the
// run's hash. Each chunk is handed to the system at once: a run that is killed leaves its frames, and is read
// without what the end would have told.

inline constexpr std::uint32_t kRecordsVersion = 8;
inline constexpr const char* kRecordsName = "records.bin";

/// Writes records.bin while a run goes on. A frame that cannot be written, because the disk is full, does not
/// end the run: finish() tells. In a folder that holds a finished run it is written beside that run's, which
/// stays until keep().
class RecordsWriter {
 public:
  /// @throws InputError when the file cannot be made
  /// @param outside RecordedRun::outside
  RecordsWriter(const std::filesystem::path& run_folder, const SequenceOrigin& origin, const Config& config,
                const std::string& outside = {});

  void add(const FrameResult& frame);

  /// @param run as it ended
  /// @throws InputError when not everything could be written
  void finish(const RunResult& run, const Trajectory& ground_truth);

  /// What was finished takes its name. @throws InputError when it cannot
  void keep();
  /// Takes away what was written.
  void discard();

 private:
  void put_chunk(char kind);

  std::filesystem::path path_;
  std::optional<WholeFile> beside_;
  std::ofstream file_;
  ByteStreamWriter content_;
  std::vector<std::uint8_t> packed_;
  int error_ = 0;  // errno of the first write that failed
};

/// A run as its folder holds it.
struct RecordedRun {
  SequenceOrigin origin;
  RunResult run;                  ///< records with their features
  std::vector<PackedMask> masks;  ///< one a record: what was removed
  Trajectory ground_truth;        ///< the sequence's, as it was
  std::string hash;               ///< run_hash of the records
  std::string outside;            ///< what another program's run is called (outside_run.hpp); empty = ours
  std::string cut_short;  ///< one sentence where the file ends early: what it holds is there without map,
                          ///< scores and adjusted poses; empty when it is whole
};

/// What a run is called: by the program that made it, else by method and odometry.
[[nodiscard]] std::string run_name(const RecordedRun& recorded);

/// @throws InputError in one sentence for a file that is missing, no records file, of another version,
/// damaged, or cut short before its first frame
[[nodiscard]] RecordedRun read_records(const std::filesystem::path& run_folder);

}  // namespace stillpoint
