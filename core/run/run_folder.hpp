#pragma once

#include <filesystem>

#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/run/sequence_origin.hpp"

namespace stillpoint {

/// Makes the folder a run is written to, before the run, so that nobody waits for frames to learn it cannot
/// be.
/// @throws InputError as prepare_out_folder does; `summary.json` and `trajectory.txt` are signs of an earlier
/// run
void prepare_run_folder(const std::filesystem::path& folder, bool force);

/// Writes what a run leaves:
///   trajectory.txt       estimated poses, TUM format, hung on the keyframes as they stand at the end
///   trajectory_live.txt  the same as first estimated
///   keyframes.txt        TUM format
///   frames.csv           a row a frame: status, counts, residuals, stage times, errors where truth exists
///   summary.json         the figures of the whole run
///   config.toml          every parameter
///   map.ply              map points and keyframe centres
/// records.bin (records_file.hpp) stands beside them, written while the run went on.
/// @param origin goes into summary.json
/// @throws InputError when one cannot be written
void write_run(const std::filesystem::path& folder, const RunResult& run, const RunReport& report,
               const FrameSource& source, const SequenceOrigin& origin);

}  // namespace stillpoint
