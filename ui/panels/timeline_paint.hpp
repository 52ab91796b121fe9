#pragma once

#include <string>
#include <vector>

#include "ui/panels/panel_kit.hpp"
#include "ui/panels/timeline_model.hpp"

namespace stillpoint {

struct RunLook;

/// How a status is drawn: lost and unreadable frames also stand lower, so that colour is not all that tells.
[[nodiscard]] LegendEntry look_of(FrameStatus status, ThemeName theme);

/// The drawing half of the timeline: rows between names on the left and values on the right. Lengths px.
class TimelinePaint {
 public:
  TimelinePaint(const UiFrame& frame, ImVec2 low, ImVec2 high, AxisRange range);

  float left = 0.0F, right = 0.0F;  ///< of what the rows show

  [[nodiscard]] const AxisMap& map() const { return map_; }
  [[nodiscard]] float x_of(double frame) const { return static_cast<float>(map_.to_pixel(frame)); }

  /// Frame numbers; the ground to drag a range on.
  void ruler(float top, float bottom) const;
  /// A row's ground; what lies right of `done` has not been processed.
  void ground(float top, float bottom, int done) const;
  /// @param indent room left for a sign before it
  void name(float top, const std::string& text, Rgb colour, float indent = 0.0F) const;
  /// A sign before a row's name.
  void name_sign(float top, float bottom, Sign sign, Rgb colour) const;
  void value(float top, const std::string& text, Rgb colour) const;
  void status(const std::vector<int>& frames, const std::vector<double>& badness, float top,
              float bottom) const;
  /// A sign at each of the frames; signs in one column are one.
  void signs(const std::vector<int>& frames, Sign sign, Rgb colour, float middle, float radius) const;
  void lane(const std::vector<int>& frames, const std::vector<double>& values, double highest, Rgb colour,
            float top, float bottom) const;
  /// A ghost's figure over the run's: its greatest values, joined and broken as its look is.
  void ghost_lane(const std::vector<int>& frames, const std::vector<double>& values, double highest,
                  const RunLook& look, float top, float bottom) const;
  void ring(int frame, double value, double highest, Rgb colour, float top, float bottom) const;
  void upright(double frame, Rgb colour, float alpha, float thickness, float top, float bottom) const;
  /// The range selected, over all rows.
  void span(const FrameSpan& span, float top, float ruler_bottom, float bottom) const;

  [[nodiscard]] float text_width(const std::string& text) const;

 private:
  void text(ImVec2 at, const std::string& words, Rgb colour) const;
  [[nodiscard]] int columns() const { return static_cast<int>(right - left); }

  const UiFrame& frame_;
  ImDrawList& list_;
  ImVec2 low_, high_;
  AxisMap map_;
};

}  // namespace stillpoint
