#pragma once

#include <imgui.h>

#include <algorithm>
#include <cstddef>

namespace stillpoint {

struct UiFrame;

/// The rows that are seen where there is no room for all.
struct RowWindow {
  std::size_t first = 0, count = 0;
  float height = 0.0F;  // px, of all rows together
};

/// @param wanted the first row to be seen; fewer than fit are never shown at the end
template <typename HeightOf>
RowWindow row_window(std::size_t rows, const HeightOf& height_of, float room, std::size_t wanted) {
  RowWindow window;
  for (std::size_t i = 0; i < rows; ++i) window.height += height_of(i);
  if (window.height <= room) return {0, rows, window.height};
  // From the end back as many as fit: nothing later is worth being the first.
  std::size_t latest = rows;
  for (float used = 0.0F; latest > 0 && used + height_of(latest - 1) <= room; --latest)
    used += height_of(latest - 1);
  window.first = std::min(wanted, std::min(latest, rows - std::min<std::size_t>(rows, 1)));
  for (float used = 0.0F; window.first + window.count < rows; ++window.count) {
    used += height_of(window.first + window.count);
    if (used > room) break;
  }
  return window;
}

/// The rows seen of those that have no room together, as a bar that can be dragged.
/// @param corner its upper right corner. @returns the first row that is to be seen from now on
[[nodiscard]] std::size_t draw_row_bar(const UiFrame& frame, const RowWindow& window, std::size_t rows,
                                       ImVec2 corner, float bottom);

}  // namespace stillpoint
