#pragma once

#include <deque>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/depth_motion.hpp"
#include "core/motion/detect_motion.hpp"
#include "core/odometry/orb_extractor.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// What odometry needs of a frame and can have before the frame's turn comes: nothing in it depends on a
/// pose.
struct PreparedFrame {
  OrbFeatures found;
  std::vector<cv::Point2f> pixels;                  ///< of the features, in the image as it is
  std::vector<cv::Point2f> undistorted;             ///< the same as a pinhole would see them
  std::shared_ptr<const MotionFrame> motion_frame;  ///< method `paper`: what later frames are compared with
  MotionTrace motion;                               ///< method `paper`: what moves
  std::shared_ptr<const RgbdView> view;             ///< method `stillpoint`: the frame made small
  SurfacePatches patches;                           ///< … and its surfaces in patches
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

  /// Takes note of a frame that another preparer prepared; null where the method compares no frames.
  void pass(const std::shared_ptr<const MotionFrame>& motion_frame);

  /// Lets go of all frames taken note of.
  void forget() { references_.clear(); }

  /// The frames the next one can be compared with, newest last.
  [[nodiscard]] const std::deque<std::shared_ptr<const MotionFrame>>& references() const {
    return references_;
  }

 private:
  Camera camera_;
  Config config_;
  OrbExtractor extractor_;
  std::deque<std::shared_ptr<const MotionFrame>>
      references_;  // newest last, as far back as motion detection looks
};

}  // namespace stillpoint
