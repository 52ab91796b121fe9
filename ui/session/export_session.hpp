#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "core/config.hpp"
#include "core/sequence/source.hpp"
#include "ui/session/sidecar.hpp"

namespace stillpoint {

/// What of a session another person is to have.
struct SessionToExport {
  const FrameSource& source;
  Config config;
  int frames = 0;                           ///< so many, from the first on
  std::string run_hash;                     ///< of their records; empty = not known
  Marks marks;                              ///< those beyond the frames are left out
  const std::atomic<bool>* stop = nullptr;  ///< when it turns true, nothing more is written
};

/// Writes a folder that `stillpoint view` opens anywhere: the frames as a TUM sequence (`sequence/`), a
/// finished run over them (run_folder.hpp), and the marks (sidecar.hpp). The run is made anew from the frames
/// as written, so that it is sure that they show the same.
/// @returns what was written, in a sentence; it says so where the run came out otherwise
/// @throws InputError in one sentence for a folder that holds a run or sequence already, and for what cannot
/// be written
std::string export_session(const SessionToExport& session, const std::filesystem::path& folder);

}  // namespace stillpoint
