#pragma once

#include <deque>
#include <memory>
#include <set>
#include <vector>

#include "core/config.hpp"
#include "core/motion/masks/outside_masks.hpp"
#include "core/motion/methods.hpp"
#include "core/motion/motion_method.hpp"

namespace stillpoint {

/// Prepares frames for a method, in order: each is given the preparations before it. A value.
class MotionPreparer {
 public:
  MotionPreparer(const Camera& camera, const Config& config);
  MotionPreparer(const MotionPreparer& other);
  MotionPreparer& operator=(const MotionPreparer& other);
  MotionPreparer(MotionPreparer&&) = default;
  MotionPreparer& operator=(MotionPreparer&&) = default;
  ~MotionPreparer() = default;

  [[nodiscard]] std::shared_ptr<const MotionPreparation> prepare(const Frame& frame, int threads);
  /// Takes note of a frame that another preparer prepared.
  void pass(const std::shared_ptr<const MotionPreparation>& prepared);

  void forget() { past_.clear(); }
  /// Frames before `next` that have to be prepared once more, after forget(), as far as they can be read.
  void restore(int next, int threads, const MotionMethod::ReadFrame& read);
  [[nodiscard]] int frames_back() const { return method_->frames_prepared_back(); }
  [[nodiscard]] const std::deque<std::shared_ptr<const MotionPreparation>>& past() const { return past_; }

 private:
  std::unique_ptr<MotionMethod> method_;
  std::unique_ptr<MotionMethod> stand_in_;  // for frames without depth; null where the method takes them
  OutsideMasks outside_;
  std::deque<std::shared_ptr<const MotionPreparation>> past_;  // newest last
};

/// A frame that was processed before, and where it was found to be.
struct PastFrame {
  Frame frame;
  Pose camera_from_world = Pose::Identity();
  bool estimated = false;  ///< the pose was measured, not predicted
};

/// The run's motion method, the one that judges frames without depth where the method cannot, and the masks
/// made elsewhere that the config adds to either. A value: a
/// copy goes on from where the original stood, and gives the same bytes from the same frames.
class MotionStage {
 public:
  MotionStage(const Camera& camera, const Config& config);
  MotionStage(const MotionStage& other);
  MotionStage& operator=(const MotionStage& other);
  MotionStage(MotionStage&&) = default;
  MotionStage& operator=(MotionStage&&) = default;
  ~MotionStage() = default;

  /// The run's method.
  [[nodiscard]] const MethodInfo& info() const { return *info_; }
  /// The one that judges this frame.
  [[nodiscard]] const MethodInfo& info_for(const Frame& frame) const;
  [[nodiscard]] const MotionMethod& method_for(const Frame& frame) const;

  [[nodiscard]] cv::Mat prior_mask(const MotionInput& input) const;
  [[nodiscard]] MotionResult detect(const MotionInput& input) const;
  void commit(const MotionInput& input, const MotionResult& result, const MotionOutcome& outcome);
  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const;

  [[nodiscard]] bool settled() const { return method_->settled(); }
  [[nodiscard]] int frames_back() const;
  void drop_images();
  [[nodiscard]] std::set<int> images_wanted(int first, int last) const;
  void restore_images(int first, int last, const MotionMethod::ReadFrame& read);

  /// How many earlier frames continued_with() needs; 0 where its state serves the new config as it is.
  [[nodiscard]] int frames_wanted(const Config& config) const;
  /// The same place under another config, made from `before`, the last frames_wanted(config) frames, newest
  /// last. With an equal config it goes on bit for bit as it would have.
  [[nodiscard]] MotionStage continued_with(const Config& config, const std::vector<PastFrame>& before) const;

 private:
  [[nodiscard]] MotionInput for_method(const MotionInput& input) const;
  [[nodiscard]] bool by_stand_in(const Frame& frame) const { return stand_in_ && !frame.has_depth(); }
  [[nodiscard]] std::unique_ptr<MotionMethod> kept_under(const Config& config) const;

  Camera camera_;
  Config config_;
  const MethodInfo* info_;
  const MethodInfo* stand_in_info_ = nullptr;
  std::unique_ptr<MotionMethod> method_, stand_in_;
  OutsideMasks outside_;
  bool stand_in_used_ = false;  // since the last frame with depth
};

}  // namespace stillpoint
