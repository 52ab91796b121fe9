#pragma once

#include <string_view>
#include <vector>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/motion/methods.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_scores.hpp"

namespace stillpoint {

[[nodiscard]] std::string_view to_string(FigureUnit unit);  ///< "m", …; "" for plain numbers, "yes/no"

/// All there are, in the order help lists them; those that only one method has come last.
[[nodiscard]] const std::vector<FigureInfo>& frame_figure_infos();

/// The figures of a run's frames as one table: a row a record, a column a figure; NaN where it is not known.
class FrameFigures {
 public:
  /// @param evaluation null, or of these records' poses
  /// @param scores empty, or one a record
  explicit FrameFigures(const std::vector<FrameRecord>& records,
                        const TrajectoryEvaluation* evaluation = nullptr,
                        const std::vector<FrameScores>& scores = {});

  [[nodiscard]] int rows() const { return static_cast<int>(frames_.size()); }
  [[nodiscard]] int frame(int row) const { return frames_[static_cast<std::size_t>(row)]; }
  /// @param column index into frame_figure_infos()
  [[nodiscard]] double value(int row, int column) const {
    return columns_[static_cast<std::size_t>(column)][static_cast<std::size_t>(row)];
  }

 private:
  std::vector<int> frames_;                   // index of each row's frame
  std::vector<std::vector<double>> columns_;  // in the order of frame_figure_infos()
};

}  // namespace stillpoint
