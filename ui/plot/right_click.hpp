#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ui/shell/ui_frame.hpp"

namespace stillpoint {

struct Plot;
struct PlotView;
struct Table;

// How what is shown gets out of the window: a right click in place on a plot or a table.

/// Something that a right click saves.
struct SaveOffer {
  std::string what;  ///< "this plot"
  FileOffer file;
  std::function<std::string()> values{};  ///< as text for the clipboard; empty: not offered
};

[[nodiscard]] SaveOffer offer_of(const std::string& name, const Plot& plot);
[[nodiscard]] SaveOffer offer_of(const std::string& name, const Plot& plot, const PlotView& view);
[[nodiscard]] SaveOffer offer_of(const std::string& name, Table table);

/// Opens a menu of offers where the right button was pressed and let go of in place, and gives them all to
/// who asks the frame for them.
/// @param hovered whether the mouse is on what is offered
/// @param make told when they are asked for or the menu is drawn; what it gives is copied
void offer_by_right_click(const UiFrame& frame, const char* id, bool hovered,
                          const std::function<std::vector<SaveOffer>()>& make);

/// The same for a table that was drawn from `low`, a place on the display, to ImGui's cursor.
void offer_table(const UiFrame& frame, const char* name, ImVec2 low, const std::function<Table()>& make);

}  // namespace stillpoint
