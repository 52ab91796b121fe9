#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/motion_stage.hpp"
#include "core/odometry/frame_preparer.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/odometry/frame_solver.hpp"
#include "core/odometry/hindsight.hpp"
#include "core/odometry/local_map.hpp"
#include "core/odometry/mapper.hpp"
#include "core/odometry/removal_check.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// RGB-D visual odometry against a local map (METHOD.md §2), with the features that config.run.method finds
/// moving taken out first. Frames go in, in order; poses come out. World coordinates are the first tracked
/// frame's camera.
///
/// A value: a copy goes on from where the original stood, and gives the same bytes from the same frames. So
/// is each of its parts.
class Odometry {
 public:
  Odometry(const Camera& camera, const Config& config);

  /// Takes the next frame. Nothing about the frame makes it throw: what cannot be tracked is marked lost.
  /// @param known_mask what truly moves, CV_8UC1; empty where it is not known. Method `oracle` alone goes by
  /// it; to the others it serves for RemovalCheck.
  [[nodiscard]] FrameResult process(const Frame& frame, const cv::Mat& known_mask = {});

  /// The same of a frame that a FramePreparer of the same camera and config prepared, frame by frame in
  /// order.
  [[nodiscard]] FrameResult process_prepared(const Frame& frame, PreparedFrame prepared,
                                             const cv::Mat& known_mask = {});

  /// The same map and the same place, but the next frames are processed with another config. What the new
  /// method needs of earlier frames is made from `before`, the last frames_wanted(config) of them, newest
  /// last. With an equal config it goes on bit for bit as it would have.
  /// @returns nothing where the map's features would not fit the new ones (another features.levels or
  /// features.scale_factor)
  [[nodiscard]] std::optional<Odometry> continued_with(const Config& config,
                                                       const std::vector<PastFrame>& before) const;

  /// How many earlier frames continued_with() needs; 0 where it has all that the new config asks for.
  [[nodiscard]] int frames_wanted(const Config& config) const;

  /// Lets go of images kept of earlier frames: what a copy that is put by need not carry.
  void drop_images();
  /// Has them again, as they were, before it goes on. @param next index of the frame it processes next
  void restore_images(int next, const std::function<Frame(int)>& read);

  /// Lets a pending bundle adjustment enter the map and looks back at the last poses: after the last frame.
  void finish();

  [[nodiscard]] const LocalMap& map() const { return mapper_.map(); }
  /// By frame index: the poses of earlier frames that were solved once more, by the map as it was later.
  [[nodiscard]] const std::map<int, HangingPose>& revised_poses() const { return hindsight_.revised(); }
  [[nodiscard]] const Config& config() const { return config_; }
  /// The motion method's state, as the next frame will find it.
  [[nodiscard]] const MotionStage& motion() const { return motion_; }

 private:
  [[nodiscard]] FrameResult run_frame(const Frame& frame, const PreparedFrame& prepared,
                                      const cv::Mat& known_mask);
  [[nodiscard]] TrackedFrame begin_map(const Frame& frame, const PreparedFrame& prepared,
                                       FrameResult& result);
  [[nodiscard]] TrackedFrame track_frame(MotionInput input, const PreparedFrame& prepared,
                                         const cv::Mat& known_mask, FrameResult& result);
  void check(const BeforeFrame& before, const Frame& frame, const PreparedFrame& prepared,
             const MotionResult& motion, const cv::Mat& known_mask, FrameRecord& record) const;
  void keep(const Frame& frame, FrameSolver::Solution& solution, FrameRecord& record);
  void lose(const Frame& frame, FrameStatus status, const std::string& why, FrameRecord& record);
  void write_pose(const Pose& camera_from_world, FrameRecord& record) const;
  [[nodiscard]] bool looks_back() const;

  Camera camera_;
  Config config_;
  FramePreparer preparer_;
  MotionStage motion_;  // what is classified as dynamic
  FrameSolver solver_;
  Mapper mapper_;
  Hindsight hindsight_;  // of frames lately tracked
};

}  // namespace stillpoint
