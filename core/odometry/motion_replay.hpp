#pragma once

#include "core/odometry/odometry.hpp"

namespace stillpoint {

/// Method `stillpoint`'s motion stage once more, from records: features, map and pose, most of a frame's
/// work, need not be had again. What it gives equals what the run had, bit for bit.
class MotionReplay {
 public:
  MotionReplay(const Camera& camera, const Config& config);

  /// A frame to compare with: one that was estimated and has depth. They are taken in order.
  /// @param log_odds what the frame left to the next one; of the last one taken only it counts
  void take(const Frame& frame, const FrameRecord& record, const cv::Mat& log_odds = {});

  /// Finds what moved, under the pose that the record has for it, and takes the frame.
  /// @returns as Odometry::process, without features and the record's other figures
  [[nodiscard]] FrameResult repeat(const Frame& frame, const FrameRecord& record);

  /// The same place, going on with another config (Odometry::continued_with).
  [[nodiscard]] std::optional<MotionReplay> continued_with(const Config& config,
                                                           const std::vector<PastFrame>& before) const;
  [[nodiscard]] int frames_wanted(const Config& config) const { return odometry_.frames_wanted(config); }

 private:
  void make_view(const Frame& frame);

  Odometry odometry_;
  bool as_the_run_ = true;  // with its config
};

}  // namespace stillpoint
