#pragma once

#include <memory>
#include <string>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/geometry/trajectory.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {

class FigureColumns;
struct FrameScores;
struct MeasuredFrames;

/// A run as far as it has come.
struct RunView {
  std::string name;      ///< its method's, or what a ghost is called
  FrameRecords records;  ///< as far as processed, in order of frames; shared with those before and after
  ChunkedList<FrameScores>
      scores;  ///< one a record: masks against the true ones, where these are known; likewise
  std::shared_ptr<FigureColumns> columns{};  ///< the run's, as it grows: the same of each of its views; may
                                             ///< be null
  Trajectory trajectory;            ///< estimated poses so far
  TrajectoryEvaluation evaluation;  ///< against ground truth, without matches where there is none

  /// Its frames, as frame figures are asked of them; refers to this run.
  [[nodiscard]] MeasuredFrames measured() const;
};

}  // namespace stillpoint
