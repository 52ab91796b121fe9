#pragma once

#include <imgui.h>

#include <functional>
#include <initializer_list>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "ui/panels/panel.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {

struct PanelsShared;

// What panels draw with: rows of controls, legends, captions, scales. Lengths in design px are times
// frame.scale.

/// A panel that has its names and what the set shares.
class NamedPanel : public Panel {
 public:
  NamedPanel(std::string name, std::string title, std::shared_ptr<PanelsShared> shared)
      : shared_(std::move(shared)), name_(std::move(name)), title_(std::move(title)) {}
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const std::string& title() const override { return title_; }

 protected:
  std::shared_ptr<PanelsShared> shared_;

 private:
  std::string name_, title_;
};

/// A box to be ticked. @returns whether it was changed
bool checkbox(const UiFrame& frame, const char* label, bool& on);

/// One that shows the frame at hand.
class FramePanel : public NamedPanel {
 public:
  using NamedPanel::NamedPanel;
  [[nodiscard]] bool previews() const override { return true; }
  [[nodiscard]] bool shows_a_run() const override { return true; }
};

/// Controls side by side, on as many lines as they need.
class Controls {
 public:
  explicit Controls(const UiFrame& frame) : frame_(frame) {}

  /// One of several, as joined buttons. @returns whether it was changed.
  bool choice(const char* id, const std::vector<std::string>& names, int& chosen,
              const char* tooltip = nullptr);
  bool toggle(const char* label, bool& on, const char* tooltip = nullptr);
  /// @param label shown after it, unless it begins with ##: `format` names it then
  bool slider(const char* label, float& value, float low, float high, const char* format);
  /// One of several rounds; `chosen` from 0, below 0 is the last.
  void round(int rounds, int& chosen);
  /// @returns whether it was pressed; `held` tells whether it is down now.
  bool button(const char* label, const char* tooltip = nullptr, bool* held = nullptr);

 private:
  void place(float width);
  [[nodiscard]] float text_width(const char* label) const;

  const UiFrame& frame_;
  float right_ = 0.0F;  // px, of what was placed last; 0 before anything was
};

/// The sign beside a name in a legend: shapes tell apart what colours may not.
enum class Sign {
  kSquare,
  kHatch,
  kBackHatch,
  kCircle,
  kRing,
  kCross,
  kHollowSquare,
  kTriangle,
  kDiamond,
  kFlag,
  kLine,
  kDashed
};

struct LegendEntry {
  std::string name;
  Rgb colour;
  Sign sign = Sign::kSquare;
};

void draw_sign(const UiFrame& frame, ImDrawList& list, ImVec2 centre, float radius, Sign sign, ImU32 colour);

/// What stands below a picture: its legend, then a sentence or figures in small type.
class Footer {
 public:
  std::vector<LegendEntry> legend;
  std::string caption;

  /// px, at the current content region's width. In a low panel the caption goes first, then the legend: the
  /// picture matters more.
  [[nodiscard]] float height(const UiFrame& frame) const;
  /// Whether there was room for the legend; known once the height is.
  [[nodiscard]] bool has_room_for_legend() const { return has_legend_; }
  /// Draws it at ImGui's cursor.
  void draw(const UiFrame& frame) const;

 private:
  float lay_out(const UiFrame& frame, bool draw) const;

  mutable bool has_legend_ = true,
               has_caption_ = true;  // as height() decided, before the picture took its room
};

/// What is left of the content region above a footer, px.
[[nodiscard]] ImVec2 room_above(const UiFrame& frame, const Footer& footer);

/// Pictures of one size, laid out in rows and columns so that they become as large as they can.
struct Tiling {
  ImVec2 size;  ///< px, of each
  ImVec2 step;  ///< px, from one to the next
  int columns = 1;
  /// Where the i-th goes when the first is at `start`.
  [[nodiscard]] ImVec2 corner(ImVec2 start, int index) const;
};
[[nodiscard]] Tiling tile(const UiFrame& frame, ImVec2 room, int count, const cv::Size& picture);

/// One line in the current font as far as there is room for it; the mouse over it shows it whole.
void text_in_room(const std::string& text, Rgb colour);

/// Lines in the current font that end at spaces alone, and never between a figure and its unit.
void text_in_lines(const std::string& text);

/// Says in the middle of what is left what is missing.
void draw_absent(const UiFrame& frame, const std::string& sentence);

/// A small heading above a picture or a plot.
void small_heading(const UiFrame& frame, const std::string& text);

/// A scale of colour beside a picture.
struct ColourScale {
  double low = 0.0, high = 1.0;
  std::string unit;                   ///< "m"
  std::function<Rgb(double)> colour;  ///< of a value between low and high
  std::string none;                   ///< name of what has no value; empty = there is none
  Rgb none_colour;
};

/// The width a scale takes, px.
[[nodiscard]] float colour_scale_width(const UiFrame& frame);
/// Draws it upright at ImGui's cursor, `height` px high.
void draw_colour_scale(const UiFrame& frame, const ColourScale& scale, float height);

/// From one colour over the theme's ground to another, for values about zero: -1 to 1.
[[nodiscard]] Rgb diverging_colour(const Theme& theme, double value);

/// For what has no value, apart from every colour of a scale.
[[nodiscard]] Rgb no_value_colour(const Theme& theme);

/// Text on a ground of its own that reads on any picture, its upper left corner at `at`. @returns its size.
ImVec2 draw_label(const UiFrame& frame, ImVec2 at, const std::string& text, Rgb colour);

/// A word on a coloured ground: "Preview", beside what is not what the run made. @param corner its upper
/// right corner. @returns its width, px
float draw_badge(const UiFrame& frame, ImVec2 corner, const std::string& text, Rgb ground);

}  // namespace stillpoint
