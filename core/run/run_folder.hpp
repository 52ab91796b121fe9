#pragma once

#include <filesystem>

#include "core/run/records_file.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/run/sequence_origin.hpp"

namespace stillpoint {

/// Makes the folder a run is written to, before the run, so that nobody waits for frames to learn it cannot
/// be.
/// @throws InputError as prepare_out_folder does: what a run writes is not written over unless `force` is set
void prepare_run_folder(const std::filesystem::path& folder, bool force);

inline constexpr const char* kSummaryName = "summary.json";

/// Writes what a run leaves, all at once when all of it is whole; until then an earlier run stays:
///   trajectory.txt       estimated poses, TUM format, hung on the keyframes as they stand at the end
///   trajectory_live.txt  the same as first estimated
///   keyframes.txt        TUM format
///   frames.csv           a row a frame: status, counts, residuals, stage times, errors where truth exists
///   summary.json         the figures of the whole run
///   config.toml          every parameter
///   map.ply              map points in their colours, and keyframe centres
///   keyframes.ply        keyframes as pyramids
/// records.bin (records_file.hpp) stands beside them, written while the run went on.
/// @param origin goes into summary.json
/// @param records of the run, whose frames it has; finished and kept here
/// @throws InputError when one cannot be written
void write_run(const std::filesystem::path& folder, const RunResult& run, const RunReport& report,
               const FrameSource& source, const SequenceOrigin& origin, RecordsWriter& records);

/// Why frames of a run could not be read, where its sequence went away while it was read: one sentence; empty
/// where it is there, and where all of them could.
/// @param where as open_sequence was given it
[[nodiscard]] std::string why_gone(const std::string& where, const RunResult& run);

}  // namespace stillpoint
