#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/motion/stage_log.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_figures.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// One frame as it is looked at: its images, read or computed again, and its record. Images a sequence lacks
/// are empty.
struct FrameView {
  int index = 0;
  Frame frame;  ///< t
  Frame
      reference;  ///< what it is compared with: StageLog::reference, or the frame before; empty for the first
  std::shared_ptr<const StageLog> motion =
      std::make_shared<const StageLog>();  ///< the run's method's stages, or those of the one that stands in
                                           ///< for it; never null
  std::shared_ptr<const StageLog> motion_beside;  ///< another method's, where these were asked for; else null
  std::shared_ptr<const StageLog> odometry;  ///< the engine's own stages; null where the record tells all
  cv::Mat mask;                              ///< CV_8UC1: what the method removed; empty = nothing
  FrameTruth truth;                          ///< for display and evaluation only
  const FrameRecord* record = nullptr;       ///< null while the frame has not been processed
  bool image_alone = false;                  ///< the rest is being worked out: mask, stages and record follow
  /// Records of the frames right before, newest first, with their features where these are kept.
  std::vector<std::shared_ptr<const FrameRecord>> history;
  /// The frame before, to be compared with; null where none was asked for or is known. Has none of its own.
  std::shared_ptr<const FrameView> before;
};

/// The stages that hold a layer: the run's own, else those laid beside; null where neither do.
[[nodiscard]] inline const StageLog* stages_with(const FrameView& view, const std::string& layer) {
  for (const auto* log : {&view.motion, &view.motion_beside, &view.odometry})
    if (*log && (*log)->layer(layer) != nullptr) return log->get();
  return nullptr;
}

/// A run as far as it has come.
struct RunView {
  std::string name;                  ///< its method's, or what a ghost is called
  std::vector<FrameRecord> records;  ///< as far as processed, in order of frames
  std::vector<FrameScores> scores;   ///< one a record: masks against the true ones, where these are known
  Trajectory trajectory;             ///< estimated poses so far
  TrajectoryEvaluation evaluation;   ///< against ground truth, without matches where there is none

  /// Its frames, as frame figures are asked of them; refers to this run.
  [[nodiscard]] MeasuredFrames measured() const { return {records, &evaluation, &scores}; }
};

}  // namespace stillpoint
