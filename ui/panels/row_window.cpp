#include "ui/panels/row_window.hpp"

#include "ui/shell/ui_frame.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {

std::size_t draw_row_bar(const UiFrame& frame, const RowWindow& window, std::size_t rows, ImVec2 corner,
                         float bottom) {
  constexpr float kBar = 7.0F;  // design px
  const ImVec2 low{corner.x - kBar * frame.scale, corner.y}, high{corner.x, bottom};
  const float whole = std::max(high.y - low.y, 1.0F), count = static_cast<float>(rows);
  std::size_t first = window.first;
  ImGui::SetCursorScreenPos(low);
  ImGui::InvisibleButton("more rows", {high.x - low.x, whole});
  const bool active = ImGui::IsItemActive(), hovered = ImGui::IsItemHovered();
  if (active) {
    const float at =
        (ImGui::GetIO().MousePos.y - low.y) / whole * count - 0.5F * static_cast<float>(window.count);
    first = static_cast<std::size_t>(std::clamp(at + 0.5F, 0.0F, count - static_cast<float>(window.count)));
  }
  if (hovered)
    ImGui::SetTooltip("%d of %d rows; drag, or Shift and the wheel, for the others",
                      static_cast<int>(window.count), static_cast<int>(rows));
  const float from = low.y + whole * static_cast<float>(window.first) / count,
              to = from + whole * static_cast<float>(window.count) / count;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float inset = 2.0F * frame.scale;
  list.AddRectFilled({low.x + inset, low.y}, high, to_u32(frame.theme.raised), inset);
  list.AddRectFilled({low.x + inset, from}, {high.x, to},
                     to_u32(hovered || active ? frame.theme.text : frame.theme.text_dim), inset);
  return first;
}

}  // namespace stillpoint
