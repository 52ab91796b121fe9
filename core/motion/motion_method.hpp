#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/motion/stage_log.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

struct Config;

// What is dynamic: the interface between a motion method and everything around it. A method judges frames,
// one after the other; the odometry acts on its judgement. README.md beside this file tells how to add one.

/// What a method asks for. What it does not ask for it is not given.
struct MotionNeeds {
  bool depth = false;       ///< frames without depth go to MethodInfo::without_depth instead
  bool first_pose = false;  ///< detect() wants the frame's pose: it runs after a first pose was estimated
  bool matches = false;     ///< detect() wants the frame's features and their map points; implies first_pose
  bool true_mask = false;   ///< detect() wants the ground-truth mask: a reference, not a method
  bool outside_masks = false;  ///< it is nothing without masks made elsewhere (config section `masks`)
  bool keeps_state = false;    ///< what it finds in a frame depends on more than frames_back() frames
  int checkpoint_every = 25;   ///< frames between copies of that state: few where a copy is light
};

/// What a method makes of a frame before its turn, when no pose is known: its own type.
struct MotionPreparation {
  virtual ~MotionPreparation() = default;
  /// What of it later frames are compared with, where that is less than all; null: the whole.
  [[nodiscard]] virtual std::shared_ptr<const MotionPreparation> for_later() const { return nullptr; }
};

/// Everything a method saw of a frame, for describe(): its own type.
struct MotionTrace {
  virtual ~MotionTrace() = default;
};

/// A feature of the frame, as methods see it that judge features.
struct MotionFeature {
  cv::Point2f pixel;                                ///< px, in the image as it is
  float depth = 0.0F;                               ///< m, 0 = none
  int map_point = -1;                               ///< id of the map point it was matched to; -1 = none
  Eigen::Vector3d world = Eigen::Vector3d::Zero();  ///< m: that point, where there is one
};

/// A frame's mask that was made elsewhere.
struct OutsideMask {
  struct Source {
    std::string name;  ///< of its folder or list
    cv::Mat mask;      ///< as `mask`; empty where it has none for the frame
  };
  cv::Mat mask;  ///< CV_8UC1, 255 = dynamic, the frame's size: of all sources; empty where none has one
  std::vector<Source> sources;
  std::string problem;  ///< why one is missing or not used; empty when all is well
};

/// A frame and what is known of it when it is judged.
struct MotionInput {
  const Frame& frame;
  std::shared_ptr<const MotionPreparation> prepared{};  ///< what prepare() made of it
  std::optional<Pose> camera_from_world{};              ///< a first pose, or for prior_mask() a predicted one
  std::span<const MotionFeature> features{};            ///< needs.matches: all features of the frame
  cv::Mat true_mask{};  ///< needs.true_mask: CV_8UC1, 255 = moving; empty where it is not known
  std::shared_ptr<const OutsideMask> outside{};  ///< null where the config names no outside masks
  int threads = 1;                               ///< any number gives the same bytes
};

/// A method's judgement of one frame.
struct MotionResult {
  cv::Mat mask;      ///< CV_8UC1, 255 = dynamic; empty = nothing is removed
  cv::Mat log_odds;  ///< CV_32FC1 of any size, covering the frame: log-odds of motion; empty = weight 1
  std::vector<float>
      weight_of_feature;        ///< one a MotionInput feature, 0 (removed) to 1; empty = the mask judges
  double mask_share = 0.0;      ///< of the frame's pixels, 0 to 1
  cv::Mat partial_mask;         ///< the mask by MethodInfo::partial_mask alone; empty = none
  int rounds = 0;               ///< of an iterative method; 0 for others
  std::vector<double> figures;  ///< one for each of MethodInfo::figures; empty where there are none
  std::shared_ptr<const MotionTrace> trace;
  std::string note;          ///< why there is no mask, or why it is to be doubted; empty when all is well
  std::string mask_problem;  ///< why a mask that was to be given, true or outside, was not; empty otherwise
  std::shared_ptr<const OutsideMask> outside;  ///< what MotionStage added to the method's own
};

/// How a judged frame ended, for a method's own state.
struct MotionOutcome {
  bool estimated = false;                     ///< the pose was measured, not predicted
  Pose camera_from_world = Pose::Identity();  ///< final
};

/// Judges what is dynamic. A value behind a pointer: a clone goes on as the original would, with the same
/// bytes. Only commit() changes it, so that a frame can be judged again, or by several threads.
class MotionMethod {
 public:
  using ReadFrame = std::function<Frame(int)>;

  virtual ~MotionMethod() = default;
  [[nodiscard]] virtual std::unique_ptr<MotionMethod> clone() const = 0;

  /// What can be had of a frame without its pose; may run on another thread, ahead of the frame's turn.
  /// @param past what prepare() made of the readable frames before, newest last, at most
  /// frames_prepared_back(). Frames are prepared in order, each once; whether commit() has seen them is not
  /// said, as preparing runs ahead.
  [[nodiscard]] virtual std::shared_ptr<const MotionPreparation> prepare(
      const Frame& frame, std::span<const std::shared_ptr<const MotionPreparation>> past, int threads) const {
    (void)frame, (void)past, (void)threads;
    return nullptr;
  }
  [[nodiscard]] virtual int frames_prepared_back() const { return 0; }

  /// What is known to be dynamic before the frame has been looked at: left out of the first pose.
  [[nodiscard]] virtual cv::Mat prior_mask(const MotionInput& input) const {
    (void)input;
    return {};
  }

  [[nodiscard]] virtual MotionResult detect(const MotionInput& input) const = 0;

  /// Takes what the next frames need of this one into the method's state.
  /// @param result what detect() gave, its mask and log-odds withdrawn where the odometry did not follow it
  virtual void commit(const MotionInput& input, const MotionResult& result, const MotionOutcome& outcome) {
    (void)input, (void)result, (void)outcome;
  }

  /// Whether it has seen frames enough to tell dynamic objects from the room.
  [[nodiscard]] virtual bool settled() const { return true; }

  /// How many frames back the frames lie, at most, that it compares one with; of a method with a recursive
  /// state, how many frames make that state anew well enough when its constants change.
  [[nodiscard]] virtual int frames_back() const { return frames_prepared_back(); }

  /// Lets go of images kept of earlier frames: what a checkpoint need not hold.
  virtual void drop_images() {}
  /// Earlier frames whose images frames first to last will be compared with, as far as they were dropped.
  [[nodiscard]] virtual std::set<int> images_wanted(int first, int last) const {
    (void)first, (void)last;
    return {};
  }
  /// Has these again, as they were.
  virtual void restore_images(int first, int last, const ReadFrame& read) {
    (void)first, (void)last, (void)read;
  }

  /// The same state under other constants; null where it does not serve them, and the state has to be made
  /// anew from frames_back() frames.
  [[nodiscard]] virtual std::unique_ptr<MotionMethod> with_config(const Config& config) const {
    (void)config;
    return nullptr;
  }

  /// The frame's way through the method, for whoever looks. @param result what detect() gave for `frame`
  [[nodiscard]] virtual StageLog describe(const Frame& frame, const MotionResult& result) const = 0;
};

}  // namespace stillpoint
