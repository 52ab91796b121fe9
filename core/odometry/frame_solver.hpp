#pragma once

#include <string>
#include <vector>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/odometry/direct_fallback.hpp"
#include "core/odometry/static_features.hpp"
#include "core/odometry/tracked_frame.hpp"
#include "core/odometry/tracker.hpp"

namespace stillpoint {

/// METHOD.md §2.1 to §2.3: where a frame was taken, given what is dynamic in it and the map as it is. The run
/// and the removal check solve by it alike. A value: the tracker and the direct fallback, with what they know
/// of earlier frames. It changes no map.
class FrameSolver {
 public:
  FrameSolver(const Camera& camera, const Config& config);
  void adopt(const Config& config);

  [[nodiscard]] const StaticFeatures& features() const { return features_; }
  [[nodiscard]] const Tracker& tracker() const { return tracker_; }
  [[nodiscard]] const CameraPath& path() const { return tracker_.path(); }
  [[nodiscard]] CameraPath& path() { return tracker_.path(); }
  [[nodiscard]] DirectFallback& direct() { return direct_; }

  /// Where a frame is held to be before it is solved.
  struct FirstPose {
    bool found = false;  ///< estimated from the frame's features; else predicted
    Pose camera_from_world = Pose::Identity();
    Vector6d velocity = Vector6d::Zero();  ///< of the camera in this frame, a second
    bool agreed = false;                   ///< a consensus of most matches
    TrackedFrame seen;                     ///< what it was estimated from
  };
  /// Whether the frame needs a first pose: to be judged under, or to know how fast the camera goes in it.
  [[nodiscard]] bool needs_first_pose(const Frame& image) const;
  [[nodiscard]] FirstPose predict(const Frame& image, const LocalMap& map) const;
  /// @param mask of what is known to be dynamic before the frame is judged; @param motion_settled whether the
  /// motion method has seen enough to know: before that, patches on a dynamic object would take the camera
  /// along
  [[nodiscard]] FirstPose first_pose(const Frame& image, const PreparedFrame& prepared, const cv::Mat& mask,
                                     const LocalMap& map, bool motion_settled, FrameRecord& record);

  struct Solution {
    TrackedFrame frame;
    std::string why_lost;  ///< empty when there is a pose
    int inliers = 0;
    bool directly = false;  ///< patches had a say in the pose
    /// The judgement left too little, and nothing was removed after all: better a pose disturbed by what
    /// moves than none.
    bool withdrawn = false;
    std::vector<int> points_in_view, points_found;  ///< map points looked for, and those found; of all tries
    [[nodiscard]] bool found() const { return why_lost.empty(); }
  };
  /// @param motion whose weights features have beside the mask
  [[nodiscard]] Solution solve(const Frame& image, const PreparedFrame& prepared, const cv::Mat& mask,
                               const MotionResult& motion, const FirstPose& first, const LocalMap& map,
                               FrameRecord& record) const;

 private:
  void track(const Frame& image, const LocalMap& map, Solution& solution, FrameRecord& record) const;

  StaticFeatures features_;
  Tracker tracker_;
  DirectFallback direct_;
  Config config_;
  Camera camera_;
  bool judged_by_pose_ = false;  // the motion method judges a frame under its first pose
};

}  // namespace stillpoint
