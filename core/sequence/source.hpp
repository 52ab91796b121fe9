#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/pose_convention.hpp"
#include "core/geometry/trajectory.hpp"
#include "core/sequence/frame.hpp"
#include "core/sequence/stamps.hpp"
#include "core/sequence/stereo/stereo_options.hpp"

namespace stillpoint {

/// A part of a sequence that may be missing.
enum class FramePart { depth, masks, truth };

/// Where frames come from. Reading is const and safe from several threads at once; the same index always
/// gives the same bytes.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// For titles: the folder's name, or `generated:KIND`.
  [[nodiscard]] virtual const std::string& name() const = 0;
  [[nodiscard]] virtual const Camera& camera() const = 0;
  [[nodiscard]] virtual int size() const = 0;
  /// Seconds; strictly increasing with the index.
  [[nodiscard]] virtual double timestamp(int index) const = 0;
  /// Stamps of all frames of the recording, s, of which these may be the first alone (OpenOptions::frames):
  /// what another program numbered are those.
  [[nodiscard]] virtual std::vector<double> recorded_stamps() const {
    std::vector<double> stamps;
    for (int i = 0; i < size(); ++i) stamps.push_back(timestamp(i));
    return stamps;
  }
  /// The frame. Never throws for a damaged file: the frame comes without the part, and says why in `problem`.
  [[nodiscard]] virtual Frame read(int index) const = 0;
  /// What is known of the frame; empty members where nothing is.
  [[nodiscard]] virtual FrameTruth truth(int index) const = 0;
  /// Ground truth as recorded, at its own rate; empty where there is none.
  [[nodiscard]] virtual const Trajectory& ground_truth() const = 0;
  /// False for a folder of colour frames alone.
  [[nodiscard]] virtual bool has_depth() const = 0;
  /// True when truth() may give masks.
  [[nodiscard]] virtual bool has_masks() const = 0;
  /// Why a part that is there is of no use, one sentence; empty where it is of use, or not there at all.
  [[nodiscard]] virtual std::string why_not(FramePart) const { return {}; }
  /// By how much depth seems to come too late (s), where it meets so few colour images that its clock is in
  /// doubt; warnings() tells it too. Nothing else may be blamed for what depth of another time does.
  [[nodiscard]] virtual std::optional<double> depth_late_s() const { return std::nullopt; }
  /// What was mended while opening, one sentence each (unsorted lists, dropped duplicates, …).
  [[nodiscard]] virtual const std::vector<std::string>& warnings() const = 0;
  /// What its file holds, a line each, where there is something to choose from: a bag's topics.
  [[nodiscard]] virtual std::vector<std::string> contents() const { return {}; }
};

struct OpenOptions {
  std::optional<Camera> camera;          ///< overrides what the folder's name says
  int frames = 0;                        ///< the first so many alone; 0 = all, a generated kind's own length
  unsigned seed = 1;                     ///< generated sequences
  double frame_rate = kFrameNumberRate;  ///< Hz, of stamps that are frame numbers
  std::optional<double> depth_scale{};   ///< depth image units a metre; overrides the camera's
  PoseConvention truth = PoseConvention::as_written;  ///< what the ground truth's poses mean
  bool inverted_masks = false;                        ///< white is what is static
  double depth_offset_s = 0.0;                        ///< added to the depth images' stamps
  std::string topics{};  ///< of a bag: `colour=/TOPIC,depth=…,info=…,truth=…`; empty = as they are found
  StereoOptions stereo{};  ///< how stereo pairs are matched
  /// Told how far what takes long on opening is (unpacking into the cache), from 0 to 1. What it throws ends
  /// that.
  std::function<void(const std::string& what, double share)> progress{};
};

/// Opens a recorded sequence or `generated:KIND`. A recorded one is a folder in the TUM RGB-D layout or
/// another that is known (rgbd/rgbd_recording.hpp, stereo/stereo_recording.hpp), an archive of one (.tar,
/// .tgz, .tar.bz2, .zip, …), a bag (ROS 1 .bag, ROS 2 .mcap and .db3, or rosbag2's folder), or a video.
/// @throws InputError in one sentence when it is neither or cannot be used.
[[nodiscard]] std::unique_ptr<FrameSource> open_sequence(const std::string& where,
                                                         const OpenOptions& options = {});

/// Whether a file is an archive, a bag or a video by its first bytes, whatever its name.
[[nodiscard]] bool is_sequence_file(const std::string& path);

}  // namespace stillpoint
