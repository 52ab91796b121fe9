#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/motion_stage.hpp"
#include "core/odometry/orb_extractor.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// What odometry needs of a frame and can have before the frame's turn comes: nothing in it depends on a
/// pose.
struct PreparedFrame {
  OrbFeatures found;
  std::vector<cv::Point2f> pixels;                  ///< of the features, in the image as it is
  std::vector<cv::Point2f> undistorted;             ///< the same as a pinhole would see them
  std::shared_ptr<const MotionPreparation> motion;  ///< what the motion method made of it
  double features_ms = 0.0, motion_ms = 0.0;        ///< wall time each took; for reading only
};

/// Prepares frames, in order. Its own thread may do so for the next frame while this one is tracked: what
/// comes out is the same. A value, as Odometry is.
class FramePreparer {
 public:
  FramePreparer(const Camera& camera, const Config& config);

  /// @param frame readable
  /// @param beside_tracking another frame is tracked meanwhile: no more threads are taken than that leaves
  [[nodiscard]] PreparedFrame prepare(const Frame& frame, bool beside_tracking = false);

  /// The motion method's preparations, for those that another preparer made.
  [[nodiscard]] MotionPreparer& motion() { return motion_; }
  [[nodiscard]] const MotionPreparer& motion() const { return motion_; }

 private:
  Camera camera_;
  OrbExtractor extractor_;
  MotionPreparer motion_;
  int threads_;
  bool judged_by_pose_;  // the method works while a frame is tracked, not before
  bool wants_orb_;       // the engine has no use for features otherwise
};

}  // namespace stillpoint
