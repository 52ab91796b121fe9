#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "core/inspect/sidecar.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

/// How far a writing is, and whether it is to go on.
struct ExportControl {
  /// Told what is done now ("frames", "run"), and how much of it; from one thread at a time.
  std::function<void(const char* what, int done, int total)> progress{};
  const std::atomic<bool>* stop = nullptr;  ///< when it turns true it ends, and takes away what it wrote
};

/// What of a session another person is to have.
struct SessionToExport {
  const FrameSource& source;
  Config config;
  int frames = 0;        ///< so many, from the first on
  std::string run_hash;  ///< of their records; empty = not known
  Marks marks;           ///< those beyond the frames are left out
};

/// Writes a folder that `stillpoint view` opens anywhere: the frames as a TUM sequence (`sequence/`), a
/// finished run over them (run_folder.hpp), and the marks (sidecar.hpp). The run is made anew from the frames
/// as written, so that it is sure that they show the same.
/// @returns what was written, or that it was stopped, in a sentence; it says so where the run came out
/// otherwise
/// @throws InputError in one sentence for a folder that holds a run or sequence already, and for what cannot
/// be written
std::string export_session(const SessionToExport& session, const std::filesystem::path& folder,
                           const ExportControl& control = {});

/// Writes some frames as a small TUM folder (export_frames).
/// @returns, throws as export_session
std::string export_selection(const FrameSource& source, const std::vector<int>& frames,
                             const std::filesystem::path& folder, const ExportControl& control = {});

}  // namespace stillpoint
