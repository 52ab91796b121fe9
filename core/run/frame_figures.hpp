#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/motion/figure_info.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {

struct FrameScores;
struct TrajectoryEvaluation;

// What is known of a frame in numbers: one table, from which conditions, the timeline's lanes, "worst", the
// comparison of runs and frames.csv all come.

[[nodiscard]] std::string_view to_string(FigureUnit unit);  ///< "m", …; "" for plain numbers, "yes/no"

/// How people are shown a figure: mm rather than m, % rather than a share.
struct ShownUnit {
  double factor = 1.0;  ///< times the figure's own unit
  std::string_view unit;
};
[[nodiscard]] ShownUnit shown_unit(FigureUnit unit);
/// "12.3 mm", "yes"; "–" where it is not known.
[[nodiscard]] std::string shown_value(const FigureInfo& figure, double value);
/// Its title, or its name.
[[nodiscard]] const std::string& shown_name(const FigureInfo& figure);

/// All there are, in the order in which help, lanes and columns have them; those that only one method has
/// come last.
[[nodiscard]] const std::vector<FigureInfo>& frame_figure_infos();

/// Its head in CSV: FigureInfo::column, or the name.
[[nodiscard]] const std::string& column_head(const FigureInfo& figure);

/// Whether it is told by the evaluation of all poses: what others are asked of needs none.
[[nodiscard]] bool needs_evaluation(int figure);

/// Index of the first figure that only one method has.
[[nodiscard]] int first_method_figure();

/// Index into frame_figure_infos(), by a figure's name, column or old name; -1 where there is none.
[[nodiscard]] int frame_figure(std::string_view name);

class FigureColumns;

/// Records and what was measured of them. Refers to all of these.
struct MeasuredFrames {
  const FrameRecords& records;
  const TrajectoryEvaluation* evaluation = nullptr;  ///< null, or of these records' poses
  const ChunkedList<FrameScores>* scores = nullptr;  ///< null, or one a record
  FigureColumns* columns = nullptr;  ///< null, or of the run that these are all or the first of
};

/// What records and scores tell of a run's frames, as it was asked for: while the run grows, only frames that
/// are new are walked over. From several threads.
class FigureColumns {
 public:
  /// frame_figure_values() of a figure that neither removal nor evaluation tells.
  [[nodiscard]] std::vector<double> values(const MeasuredFrames& frames, int figure);

 private:
  std::mutex mutex_;
  std::map<int, std::vector<double>> columns_;  // by figure, as far as it was asked for
};

/// One figure of each record; NaN where it is not known.
/// @param figure index into frame_figure_infos()
[[nodiscard]] std::vector<double> frame_figure_values(const MeasuredFrames& frames, int figure);

/// All figures of one record, in the order of frame_figure_infos(); NaN where one is not known. Those of the
/// removal check are not: they are judged over a run.
[[nodiscard]] std::vector<double> figures_of_frame(const MeasuredFrames& frames, std::size_t row);

/// Goes from frame to frame and tells all figures of each, in the order of frame_figure_infos(): what needs
/// no more of a long run than one frame at a time.
void walk_figures(const MeasuredFrames& frames,
                  const std::function<void(const FrameRecord&, const std::vector<double>&)>& take);

/// The figures of a run's frames as one table: a row a record, a column a figure; NaN where it is not known.
class FrameFigures {
 public:
  explicit FrameFigures(const MeasuredFrames& frames);
  /// Some figures alone, indices into frame_figure_infos(): no other may be asked for.
  FrameFigures(const MeasuredFrames& frames, const std::set<int>& figures);

  [[nodiscard]] int rows() const { return static_cast<int>(frames_.size()); }
  [[nodiscard]] int frame(int row) const { return frames_[static_cast<std::size_t>(row)]; }
  /// @param column index into frame_figure_infos()
  [[nodiscard]] double value(int row, int column) const {
    return columns_[static_cast<std::size_t>(column)].at(static_cast<std::size_t>(row));
  }

 private:
  std::vector<int> frames_;                   // index of each row's frame
  std::vector<std::vector<double>> columns_;  // in the order of frame_figure_infos()
};

}  // namespace stillpoint
