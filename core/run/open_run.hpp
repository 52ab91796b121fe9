#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/run/records_file.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

/// A finished run, opened to be looked at.
struct OpenedRun {
  std::shared_ptr<const RecordedRun> recorded;  ///< never null
  std::shared_ptr<const FrameSource> source;    ///< its sequence, or a stand-in without images; never null
  std::string no_images;  ///< why the stand-in serves, one sentence; empty = it does not
};

/// Whether a folder holds what `stillpoint run` leaves, and is no sequence.
[[nodiscard]] bool is_run_folder(const std::filesystem::path& folder);

/// @throws InputError in one sentence for a folder that holds no run's records: one that is missing, or a
/// sequence's, or a run's that lost them
void throw_if_no_records(const std::filesystem::path& folder);

/// Opens a run's folder, and the sequence it was of where that still is what it was.
/// @param sequence where the sequence lies now; empty = where it lay, or, when run and sequence were moved
/// together, where it lies from the run's folder
/// @throws InputError in one sentence for records that are missing or cannot be read, and for a `sequence`
/// given that cannot be opened or is another one
[[nodiscard]] OpenedRun open_run(const std::filesystem::path& folder, const std::string& sequence = "");

}  // namespace stillpoint
