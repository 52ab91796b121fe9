#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/sequence/source.hpp"

namespace stillpoint {

struct RgbdLayout;

/// How a sequence's files are named and laid out.
enum class SequenceLayout {
  own,         ///< RGB-D as tum, stereo as left_right
  tum,         ///< `rgb/`, `depth/` and their lists
  left_right,  ///< `left/`, `right/` and `camera.toml` with the baseline
  kitti,       ///< KITTI odometry: `image_2/`, `image_3/`, `calib.txt`, `times.txt`, `poses.txt`
  euroc,       ///< EuRoC/ASL: `mav0/cam0`, `mav0/cam1`, ground truth of a body; grey images
};

struct WriteOptions {
  bool force = false;  ///< replace the sequence that the folder holds
  int threads = 2;     ///< frames are made and packed side by side; the files do not depend on how many
  /// Told after each frame how many are done, of how many; called from one thread at a time.
  std::function<void(int done, int total)> progress{};
  SequenceLayout layout = SequenceLayout::own;
  const RgbdLayout* rgbd = nullptr;  ///< a layout of rgbd/rgbd_recording.hpp in place of tum; null = none
  const std::atomic<bool>* stop = nullptr;  ///< when it turns true the sequence ends with the frames at hand
};

/// What was written.
struct WrittenSequence {
  int frames = 0;               ///< fewer than the source has when it was stopped
  std::vector<int> unreadable;  ///< of these: the lists name their images, which are not there
  std::int64_t too_far = 0;     ///< pixels whose depth 16 bits cannot hold: written as not measured
  double depth_units = 0.0;     ///< a metre, as stored
};

/// Writes a sequence as a folder, RGB-D in TUM RGB-D layout: `rgb/`, `depth/` (16 bit), `mask/` (255 =
/// moving), the three lists, `groundtruth.txt`, `associations.txt` and `camera.toml`. It is written beside
/// the folder, as FOLDER.part, and takes its place when it is whole: until then an earlier sequence stays,
/// whatever ends the program. Every frame keeps its number: of one that cannot be read, or has no depth, the
/// lists name the image that is missing, and who reads the folder is told so. Stereo pairs are written as
/// they were matched, rectified, in a layout of theirs; masks and their list as above.
/// @throws InputError in one sentence for a sequence without frames or without one that can be read, a layout
/// that is not the source's kind, a folder
///         that holds a sequence already (unless forced), and whatever cannot be written (no permission, disk
///         full).
WrittenSequence write_sequence(const FrameSource& source, const std::filesystem::path& folder,
                               const WriteOptions& options = {});

/// The camera of a sequence's frames as they come, whose depth is registered.
[[nodiscard]] Camera registered_camera(const FrameSource& source);

/// A camera as camera.toml has it, with its depth camera.
[[nodiscard]] std::string camera_text(const Camera& camera);

/// Takes away a sequence that write_sequence wrote, finished or not, and folders that are empty then.
void remove_sequence(const std::filesystem::path& folder);

}  // namespace stillpoint
