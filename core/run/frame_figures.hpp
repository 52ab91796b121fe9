#pragma once

#include <string_view>
#include <vector>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_scores.hpp"

namespace stillpoint {

/// What a figure is measured in; times in ms, lengths in m, shares 0 to 1.
enum class FigureUnit : std::uint8_t { plain, metres, degrees, pixels, milliseconds, share, truth };

[[nodiscard]] std::string_view to_string(FigureUnit unit);  ///< "m", …; "" for plain numbers, "yes/no"

/// A figure known of each frame, by the name that conditions use.
struct FrameFigureInfo {
  std::string_view name;
  FigureUnit unit = FigureUnit::plain;
  std::string_view help;  ///< one line
};

/// All there are, in the order help lists them.
[[nodiscard]] const std::vector<FrameFigureInfo>& frame_figure_infos();

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
