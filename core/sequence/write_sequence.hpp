#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/sequence/source.hpp"

namespace stillpoint {

struct WriteOptions {
  bool force = false;  ///< replace the sequence that the folder holds
  int threads = 2;     ///< frames are made and packed side by side; the files do not depend on how many
  /// Told after each frame how many are done, of how many; called from one thread at a time.
  std::function<void(int done, int total)> progress{};
  const std::atomic<bool>* stop = nullptr;  ///< when it turns true the sequence ends with the frames at hand
};

/// What was written.
struct WrittenSequence {
  int frames = 0;               ///< fewer than the source has when it was stopped
  std::vector<int> unreadable;  ///< of these: the lists name their images, which are not there
};

/// Writes a sequence as a folder in TUM RGB-D layout: `rgb/`, `depth/` (16 bit), `mask/` (255 = moving), the
/// three lists, `groundtruth.txt`, `associations.txt` and `camera.toml`. The lists come last, so that a
/// folder whose writing was cut short is no sequence. Every frame keeps its number: of one that cannot be
/// read, or has no depth, the lists name the image that is missing, and who reads the folder is told so.
/// @throws InputError in one sentence for a sequence without frames or without one that can be read, a folder
///         that holds a sequence already (unless forced), and whatever cannot be written (no permission, disk
///         full).
WrittenSequence write_sequence(const FrameSource& source, const std::filesystem::path& folder,
                               const WriteOptions& options = {});

/// Takes away a sequence that write_sequence wrote, finished or not, and folders that are empty then.
void remove_sequence(const std::filesystem::path& folder);

}  // namespace stillpoint
