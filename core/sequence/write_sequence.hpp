#pragma once

#include <atomic>
#include <filesystem>
#include <functional>

#include "core/sequence/source.hpp"

namespace stillpoint {

struct WriteOptions {
  bool force = false;  ///< replace the sequence that the folder holds
  int threads = 2;     ///< frames are made and packed side by side; the files do not depend on how many
  /// Told after each frame how many are done, of how many; called from one thread at a time.
  std::function<void(int done, int total)> progress{};
  const std::atomic<bool>* stop = nullptr;  ///< when it turns true the sequence ends with the frames at hand
};

/// Writes a sequence as a folder in TUM RGB-D layout: `rgb/`, `depth/` (16 bit), `mask/` (255 = moving), the
/// three lists, `groundtruth.txt`, `associations.txt` and `camera.toml`. The lists come last, so that a
/// folder whose writing was cut short is no sequence.
/// @returns how many frames it holds: fewer than the source has when it was stopped
/// @throws InputError in one sentence for a sequence without frames, a folder that holds a sequence already
/// (unless
///         forced), a frame that cannot be read, and whatever cannot be written (no permission, disk full).
int write_sequence(const FrameSource& source, const std::filesystem::path& folder,
                   const WriteOptions& options = {});

}  // namespace stillpoint
