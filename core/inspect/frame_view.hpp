#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/sequence/frame.hpp"

namespace stillpoint {

struct FrameRecord;
struct StageLog;

/// A log of nothing: what stands where no method has described itself. Never null.
[[nodiscard]] std::shared_ptr<const StageLog> no_stages();

/// One frame as it is looked at: its images, read or computed again, and its record. Images a sequence lacks
/// are empty.
struct FrameView {
  int index = 0;
  Frame frame;  ///< t
  Frame
      reference;  ///< what it is compared with: StageLog::reference, or the frame before; empty for the first
  std::shared_ptr<const StageLog> motion = no_stages();  ///< the run's method's stages, or those of the one
                                                         ///< that stands in for it; never null
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
[[nodiscard]] const StageLog* stages_with(const FrameView& view, const std::string& layer);

}  // namespace stillpoint
