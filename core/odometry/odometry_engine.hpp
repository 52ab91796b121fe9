#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/motion_stage.hpp"
#include "core/odometry/frame_preparer.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/odometry/local_map.hpp"
#include "core/odometry/smoother.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

class ByteStore;

/// A way to tell where the camera is, behind any motion method: what Odometry is a handle on. FeatureOdometry
/// is METHOD.md §2; an engine of another kind (dense, direct) is a class beside it and a line in
/// engines.cpp. What each function owes its callers stands with Odometry.
///
/// An engine's poses hang on keyframes of its map, so that they follow when the map is adjusted. One that
/// adjusts none keeps a single keyframe, where the world's coordinates begin.
class OdometryEngine {
 public:
  virtual ~OdometryEngine() = default;
  /// Goes on from where the original stands, and gives the same bytes from the same frames.
  [[nodiscard]] virtual std::unique_ptr<OdometryEngine> clone() const = 0;

  [[nodiscard]] virtual FrameResult process(const Frame& frame, const cv::Mat& known_mask) = 0;
  [[nodiscard]] virtual FrameResult process_prepared(const Frame& frame, PreparedFrame prepared,
                                                     const cv::Mat& known_mask) = 0;
  virtual void finish() = 0;

  /// @returns null where its state does not serve the config
  [[nodiscard]] virtual std::unique_ptr<OdometryEngine> continued_with(
      const Config& config, const std::vector<PastFrame>& before) const = 0;
  [[nodiscard]] virtual int frames_wanted(const Config& config) const = 0;
  virtual void shelve_features(ByteStore& /*store*/) {}
  virtual void drop_images() = 0;
  virtual void restore_images(int next, const std::function<Frame(int)>& read) = 0;

  [[nodiscard]] virtual const LocalMap& map() const = 0;
  [[nodiscard]] virtual const RevisedPoses& revised_poses() const = 0;
  [[nodiscard]] virtual const Config& config() const = 0;
  [[nodiscard]] virtual const MotionStage& motion() const = 0;

 protected:
  OdometryEngine() = default;
  OdometryEngine(const OdometryEngine&) = default;
  OdometryEngine& operator=(const OdometryEngine&) = default;
};

/// The engine a config runs.
/// @throws InputError where the config's method cannot stand in front of it (why_no_pair)
[[nodiscard]] std::unique_ptr<OdometryEngine> make_odometry_engine(const Camera& camera,
                                                                   const Config& config);

}  // namespace stillpoint
