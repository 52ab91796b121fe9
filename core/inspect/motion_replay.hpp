#pragma once

#include <set>

#include "core/motion/motion_stage.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {

/// What a motion method found in a frame, once more.
struct MotionAgain {
  MotionResult motion;
  cv::Mat mask;  ///< what was removed, CV_8UC1; empty = nothing
};

/// A method's motion stage once more, from records: features, map and pose, most of a frame's work, need not
/// be had again. What it gives equals what the run had, bit for bit. Not for methods that need matches.
class MotionReplay {
 public:
  /// Before the first frame.
  MotionReplay(const Camera& camera, const Config& config);
  /// From a state that stood before frame `next`, its images dropped, on to frame `last`.
  MotionReplay(const Camera& camera, const Config& config, MotionStage state, int next, int last,
               const MotionMethod::ReadFrame& read);

  /// Finds what moved, under the pose that the record has for it, and takes the frame into the state.
  /// @param record null: the frame was not processed; methods that need a pose then find nothing
  [[nodiscard]] MotionAgain repeat(const Frame& frame, const FrameRecord* record,
                                   const cv::Mat& true_mask = {});

  /// The same place, going on with another config (MotionStage::continued_with).
  [[nodiscard]] MotionReplay continued_with(const Config& config, const std::vector<PastFrame>& before) const;
  [[nodiscard]] int frames_wanted(const Config& config) const { return stage_.frames_wanted(config); }

  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& motion) const {
    return stage_.describe(frame, motion);
  }

 private:
  Camera camera_;
  Config config_;
  MotionStage stage_;
  MotionPreparer preparer_;
  bool as_the_run_ = true;  // with its config
};

}  // namespace stillpoint
