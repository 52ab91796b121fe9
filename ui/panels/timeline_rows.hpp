#pragma once

#include <string>

#include "ui/panels/timeline_paint.hpp"

namespace stillpoint {

struct FigureInfo;

/// The timeline's rows that are there whatever lanes are chosen. For the frame of the interface being drawn
/// only.
class TimelineRows {
 public:
  TimelineRows(const UiFrame& frame, const SessionView& session, const TimelineModel& model,
               const TimelinePaint& paint)
      : frame_(frame), session_(session), model_(model), paint_(paint) {}

  void status(float top, float bottom) const;
  /// Keyframes, breakpoint hits, bookmarks, frames that removal hurt.
  void marks(float top, float bottom) const;
  /// How far a ghost has got, where it branched off and where it parts.
  void ghost(std::size_t index, float top, float bottom) const;

 private:
  const UiFrame& frame_;
  const SessionView& session_;
  const TimelineModel& model_;
  const TimelinePaint& paint_;
};

[[nodiscard]] Rgb lane_colour(const FigureInfo& figure, ThemeName theme);
/// A lane's value to a tenth, with its unit; "–" for none.
[[nodiscard]] std::string lane_text(double value, const FigureInfo& figure);

/// All that is known of a frame, for the box beside the mouse.
[[nodiscard]] std::string frame_report(const SessionView& session, const TimelineModel& model, int index);

[[nodiscard]] Footer timeline_footer(const UiFrame& frame, const SessionView& session,
                                     const FigureInfo& worst_by);

}  // namespace stillpoint
