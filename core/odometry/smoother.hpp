#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "core/chunked_list.hpp"
#include "core/odometry/local_map.hpp"
#include "core/odometry/pose_solver.hpp"
#include "core/odometry/tracked_frame.hpp"

namespace stillpoint {

/// A frame's pose, hanging on a keyframe of the map: it goes where bundle adjustment takes the keyframe.
struct KeyframeRelativePose {
  int reference_keyframe = kNone;
  Pose camera_from_reference = Pose::Identity();
};

/// Poses of earlier frames that were solved once more, in order of frames. What a long run holds of each of
/// its frames is one of these, and copies of it share them.
class RevisedPoses {
 public:
  /// @param frame index, above those before it
  void add(int frame, const KeyframeRelativePose& pose);
  /// Of a frame; nothing where it was not solved once more.
  [[nodiscard]] std::optional<KeyframeRelativePose> of(int frame) const;
  [[nodiscard]] std::size_t size() const { return all_.size(); }
  [[nodiscard]] bool empty() const { return all_.empty(); }
  /// Bytes of memory, those shared with copies included.
  [[nodiscard]] std::size_t held_bytes() const { return all_.held_bytes(); }

 private:
  struct Entry {
    int frame = 0, reference_keyframe = kNone;
    std::array<double, 12> camera_from_reference{};  // column by column, without the last row
  };
  ChunkedList<Entry> all_;
};

/// Looks back at poses. When a frame is new, little is known of what it shows: its map points are as one
/// keyframe measured them, and what has only begun to move is not known to. Some time later, when the points
/// have been adjusted and those that moved have left the map, its pose is solved once more from the same
/// matches, as far as their points are still in the map (those culled or merged into others are not). Copies
/// share what is remembered of frames not yet looked back at.
class FixedLagSmoother {
 public:
  /// A match that a frame's pose agreed with.
  struct InlierMatch {
    int point = kNone;
    float u = 0.0F, v = 0.0F;  ///< px, undistorted
    float depth = 0.0F;        ///< m; 0 = none
    float sigma_px = 1.0F;
    float static_weight = 1.0F;
  };

  void remember(int frame_index, const KeyframeRelativePose& pose, std::vector<InlierMatch> matches);

  /// Solves anew the poses of all frames up to `last`, each once.
  void advance(int last, const LocalMap& map, const Camera& camera, const TrackingConfig& config);

  /// The poses that were solved anew. Where too few of the matches were left, or agreed, the pose stays as it
  /// was.
  [[nodiscard]] const RevisedPoses& revised() const { return revised_; }

  /// How many frames are not yet looked back at.
  [[nodiscard]] std::size_t pending() const { return past_.size(); }
  /// Leaves these as they are.
  void forget_pending() { past_.clear(); }

 private:
  struct Past {
    int frame_index = 0;
    KeyframeRelativePose pose;
    std::vector<InlierMatch> matches;
  };
  std::deque<std::shared_ptr<const Past>> past_;  // oldest first
  RevisedPoses revised_;
};

/// The matches that a tracked frame's pose agreed with. @param scales standard deviation of each octave's
/// pixels, px
[[nodiscard]] std::vector<FixedLagSmoother::InlierMatch> inlier_matches_of(const TrackedFrame& frame,
                                                                           const std::vector<double>& scales);

}  // namespace stillpoint
