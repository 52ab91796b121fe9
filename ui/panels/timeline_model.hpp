#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/inspect/marks.hpp"
#include "core/odometry/frame_record.hpp"
#include "ui/plot/plot_axis.hpp"

namespace stillpoint {

struct RunView;
struct SessionView;

// The timeline's arithmetic: what falls into each column of pixels, and the range a drag selects. No ImGui.

/// What the frames in one column of pixels hold.
struct ColumnValues {
  double least = 0.0, greatest = 0.0;  ///< NaN where there is nothing
};

/// The least and greatest value of each column of pixels: nothing a column hides is lost, however many frames
/// share it, and a frame wider than a column fills all of its own.
/// @param frames the frame of each value, ascending; frame f reaches from f - 1/2 to f + 1/2
/// @param range of frames that the columns show
[[nodiscard]] std::vector<ColumnValues> aggregate(std::span<const int> frames, std::span<const double> values,
                                                  const AxisRange& range, int columns);

/// Columns of equal values put together: what is drawn as one.
struct ColumnRun {
  int first = 0, last = 0;  ///< columns, both among them
  ColumnValues values;
};
[[nodiscard]] std::vector<ColumnRun> runs_of(const std::vector<ColumnValues>& columns);

/// Columns in which at least one of the frames lies, ascending, each once.
[[nodiscard]] std::vector<int> columns_of(const std::vector<int>& frames, const AxisRange& range,
                                          int columns);

/// One lane: a figure of the run, and of each ghost beside it.
struct TimelineLane {
  int figure = 0;              ///< index into frame_figure_infos()
  std::vector<double> values;  ///< one a record of the run, in the unit people are shown (shown_unit)
  std::vector<std::vector<double>> ghosts;  ///< one a record of each ghost
  double greatest = 0.0;                    ///< of all values, those of ghosts too; 0 where none is above
  double highest = 1.0;                     ///< upper end of the lane, above 0

  /// "0–72.65 mm": between which its values lie; "0 mm" where none is above.
  [[nodiscard]] std::string range_text() const;
};

/// The run as the timeline shows it, made anew only when the run or the choice of lanes changes.
class TimelineModel {
 public:
  void update(const SessionView& session, const std::vector<int>& wanted);

  std::vector<int> frames;                     ///< of the run's records
  std::vector<double> badness;                 ///< of each record's status: 0 tracked … 4 unreadable
  std::vector<std::vector<int>> ghost_frames;  ///< of each ghost's records
  std::vector<std::vector<double>> ghost_badness;
  std::vector<int> keyframes;
  std::vector<TimelineLane> lanes;

 private:
  struct Key {
    const RunView* run = nullptr;
    std::uint64_t revision = 0;
    std::size_t records = 0;
    std::vector<std::pair<const RunView*, std::size_t>> ghosts;  // with how many records
    std::vector<int> wanted;
    bool operator==(const Key&) const = default;
  };
  Key key_;
};

/// 0 for tracked to 4 for unreadable: of frames that share a column the worst is shown.
[[nodiscard]] double badness_of(FrameStatus status);
[[nodiscard]] FrameStatus status_of_badness(double badness);

/// A range being dragged out, or an end of the one there is being moved.
class SpanDrag {
 public:
  /// @param reach frames within which an end of the present range is taken hold of
  void begin(int frame, const std::optional<FrameSpan>& present, double reach);
  void move(int frame);
  /// The range so far; nothing while the mouse has not left the frame it was pressed on.
  [[nodiscard]] std::optional<FrameSpan> span(int frame_count) const;
  [[nodiscard]] bool active() const { return anchor_.has_value(); }
  /// @returns the range, and is at rest again
  std::optional<FrameSpan> end(int frame_count);

 private:
  std::optional<int> anchor_;
  int at_ = 0;
  bool moved_ = false;
};

}  // namespace stillpoint
