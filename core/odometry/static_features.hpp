#pragma once

#include <optional>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/motion_method.hpp"
#include "core/odometry/frame_preparer.hpp"
#include "core/odometry/tracked_frame.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// METHOD.md §1.6 and §2.1: takes out of a frame's features what is dynamic, and gives those that are left
/// their depth and weight, as a frame taken all at once would show them. A value without memory of earlier
/// frames.
class StaticFeatures {
 public:
  StaticFeatures(const Camera& camera, const TrackingConfig& tracking)
      : camera_(camera), tracking_(tracking) {}

  /// @param mask CV_8UC1 as large as the frame, 255 = dynamic; empty: nothing is removed by it
  /// @param velocity of the camera in this frame, a second: rolling shutter and late depth are undone by it
  /// @param motion whose weights, if any, the features are given
  [[nodiscard]] TrackedFrame select(const Frame& frame, const PreparedFrame& prepared, const cv::Mat& mask,
                                    const Vector6d& velocity, const MotionResult& motion = {}) const;

  /// Whether what is selected depends on how fast the camera goes.
  [[nodiscard]] bool depend_on_velocity(const Frame& frame) const;
  /// s, from the frame's time to depth's stamp; nothing where it is not to be corrected.
  [[nodiscard]] std::optional<double> depth_lag(const Frame& frame) const;
  /// Whether so little of the view is left that it tells no room from a dynamic object.
  [[nodiscard]] bool too_few_places(const TrackedFrame& frame) const;

 private:
  Camera camera_;
  TrackingConfig tracking_;
};

}  // namespace stillpoint
