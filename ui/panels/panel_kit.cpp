#include "ui/panels/panel_kit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "ui/plot/plot_axis.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/text.hpp"
#include "ui/view/picture_strips.hpp"

namespace stillpoint {
namespace {

constexpr float kBarWidth = 12.0F;  // design px: wide enough to compare colours

ImVec2 small_extent(const UiFrame& frame, const std::string& text, float wrap = 0.0F) {
  const ImFont* font = frame.fonts.small;
  return font->CalcTextSizeA(font->FontSize, 1e6F, wrap, text.c_str());
}

void small_text(const UiFrame& frame, ImVec2 at, const std::string& text, Rgb colour, float wrap = 0.0F) {
  ImGui::GetWindowDrawList()->AddText(frame.fonts.small, frame.fonts.small->FontSize,
                                      {std::round(at.x), std::round(at.y)}, to_u32(colour), text.c_str(),
                                      nullptr, wrap);
}

}  // namespace

// Legends and captions
// --------------------------------------------------------------------------------------------

void draw_sign(const UiFrame& frame, ImDrawList& list, ImVec2 centre, float radius, Sign sign, ImU32 colour) {
  const float r = radius, thin = 1.5F * frame.scale;
  const ImVec2 low{centre.x - r, centre.y - r}, high{centre.x + r, centre.y + r};
  const ImU32 faint = (colour & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 90);
  switch (sign) {
    case Sign::kSquare:
      list.AddRectFilled(low, high, colour, frame.scale);
      return;
    case Sign::kHatch:
      list.AddRectFilled(low, high, faint);
      list.AddLine({low.x, high.y}, {high.x, low.y}, colour, 2.0F * thin);
      return;
    case Sign::kBackHatch:
      list.AddRectFilled(low, high, faint);
      list.AddLine(low, high, colour, 2.0F * thin);
      return;
    case Sign::kCircle:
      list.AddCircleFilled(centre, r, colour);
      return;
    case Sign::kRing:
      list.AddCircle(centre, r, colour, 0, thin);
      return;
    case Sign::kCross:
      list.AddLine(low, high, colour, thin);
      list.AddLine({low.x, high.y}, {high.x, low.y}, colour, thin);
      return;
    case Sign::kHollowSquare:
      list.AddRect(low, high, colour, 0.0F, ImDrawFlags_None, thin);
      return;
    case Sign::kTriangle:
      list.AddTriangleFilled({centre.x - r, high.y}, {high.x, high.y}, {centre.x, low.y}, colour);
      return;
    case Sign::kDiamond:
      list.AddQuadFilled({low.x, centre.y}, {centre.x, low.y}, {high.x, centre.y}, {centre.x, high.y},
                         colour);
      return;
    case Sign::kFlag:
      list.AddLine({low.x, low.y}, {low.x, high.y}, colour, thin);
      list.AddTriangleFilled({low.x, low.y}, {high.x, low.y + 0.6F * r}, {low.x, low.y + 1.2F * r}, colour);
      return;
    case Sign::kLine:
      list.AddLine({centre.x - 2.0F * r, centre.y}, {centre.x + 2.0F * r, centre.y}, colour, 1.4F * thin);
      return;
    case Sign::kDashed:
      list.AddLine({centre.x - 2.0F * r, centre.y}, {centre.x - 0.4F * r, centre.y}, colour, 1.4F * thin);
      list.AddLine({centre.x + 0.4F * r, centre.y}, {centre.x + 2.0F * r, centre.y}, colour, 1.4F * thin);
      return;
  }
}

float Footer::lay_out(const UiFrame& frame, bool draw) const {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float width = std::max(ImGui::GetContentRegionAvail().x, 1.0F);
  const float line = frame.fonts.small->FontSize + 4.0F * frame.scale;
  const float sign_room = 22.0F * frame.scale, gap = 16.0F * frame.scale;
  float x = 0.0F, y = 0.0F;
  for (const LegendEntry& entry : legend) {
    if (!has_legend_) break;
    const float needed = sign_room + small_extent(frame, entry.name).x;
    if (x > 0.0F && x + needed > width) {
      x = 0.0F;
      y += line;
    }
    if (draw) {
      const ImVec2 at{corner.x + x, corner.y + y};
      draw_sign(frame, *ImGui::GetWindowDrawList(),
                {std::round(at.x + 0.36F * sign_room), std::round(at.y + 0.5F * frame.fonts.small->FontSize)},
                4.0F * frame.scale, entry.sign, to_u32(entry.colour));
      small_text(frame, {at.x + sign_room, at.y}, entry.name, frame.theme.text);
    }
    x += needed + gap;
  }
  if (!legend.empty() && has_legend_) y += line;
  if (!caption.empty() && has_caption_) {
    const std::string lines = in_lines(*frame.fonts.small, caption, width);
    if (draw) small_text(frame, {corner.x, corner.y + y}, lines, frame.theme.text_dim, width);
    y += small_extent(frame, lines, width).y;
  }
  return y;
}

float Footer::height(const UiFrame& frame) const {
  constexpr float kMostShare = 0.3F;  // of the room that is there
  const float most = kMostShare * ImGui::GetContentRegionAvail().y;
  has_legend_ = has_caption_ = true;
  if (lay_out(frame, false) > most) has_caption_ = false;
  if (lay_out(frame, false) > most) has_legend_ = false;
  return lay_out(frame, false);
}

void Footer::draw(const UiFrame& frame) const {
  const float used = lay_out(frame, true);
  ImGui::Dummy({1.0F, used});
}

ImVec2 room_above(const UiFrame& frame, const Footer& footer) {
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float below = footer.height(frame) + ImGui::GetStyle().ItemSpacing.y;
  return {room.x, std::max(room.y - below, 40.0F * frame.scale)};
}

ImVec2 Tiling::corner(ImVec2 start, int index) const {
  return {start.x + step.x * static_cast<float>(index % columns),
          start.y + step.y * static_cast<float>(index / columns)};
}

Tiling tile(const UiFrame& frame, ImVec2 room, int count, const cv::Size& picture) {
  const float gap = 4.0F * frame.scale;
  const float aspect = picture.height > 0
                           ? static_cast<float>(picture.width) / static_cast<float>(picture.height)
                           : 4.0F / 3.0F;
  Tiling best;
  float best_width = -1.0F;
  for (int columns = 1; columns <= count; ++columns) {
    const int rows = (count + columns - 1) / columns;
    const ImVec2 size{
        std::floor((room.x - gap * static_cast<float>(columns - 1)) / static_cast<float>(columns)),
        std::floor((room.y - gap * static_cast<float>(rows - 1)) / static_cast<float>(rows))};
    const float width = std::min(size.x, size.y * aspect);
    if (width <= best_width) continue;
    best_width = width;
    best = {size, {size.x + gap, size.y + gap}, columns};
  }
  return best;
}

void text_in_room(const std::string& text, Rgb colour) {
  const std::string shown = cut_to(*ImGui::GetFont(), text, ImGui::GetContentRegionAvail().x);
  ImGui::TextColored(to_vec4(colour), "%s", shown.c_str());
  if (shown != text && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text.c_str());
}

void text_in_lines(const std::string& text) {
  ImGui::TextWrapped("%s", in_lines(*ImGui::GetFont(), text, ImGui::GetContentRegionAvail().x).c_str());
}

void draw_absent(const UiFrame& frame, const std::string& sentence) {
  if (frame.strips != nullptr) {
    frame.strips->say_absent(sentence);
    return;
  }
  const ImVec2 corner = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
  const float wrap = std::max(0.8F * room.x, 60.0F);
  const ImVec2 extent = ImGui::CalcTextSize(sentence.c_str(), nullptr, false, wrap);
  const ImVec2 at{std::round(corner.x + 0.5F * (room.x - extent.x)),
                  std::round(corner.y + 0.5F * std::max(room.y - extent.y, 0.0F))};
  ImGui::GetWindowDrawList()->AddText(frame.fonts.text, frame.fonts.text->FontSize, at,
                                      to_u32(frame.theme.text_dim), sentence.c_str(), nullptr, wrap);
  ImGui::Dummy({std::max(room.x, 1.0F), std::max(room.y, extent.y)});
}

void small_heading(const UiFrame& frame, const std::string& text) {
  ImGui::PushFont(frame.fonts.small);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopFont();
}

// Scales
// ----------------------------------------------------------------------------------------------------------

float colour_scale_width(const UiFrame& frame) { return 62.0F * frame.scale; }

void draw_colour_scale(const UiFrame& frame, const ColourScale& scale, float height) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float line = frame.fonts.small->FontSize + 4.0F * frame.scale;
  const float none_room = scale.none.empty() ? 0.0F : 2.0F * line;
  const float top = corner.y + line,
              bottom = corner.y + std::max(height - none_room - 0.5F * line, 2.0F * line);
  const float width = kBarWidth * frame.scale;
  small_text(frame, corner, scale.unit, frame.theme.text_dim);
  constexpr int kSteps = 64;  // bands of the scale: it looks even
  for (int i = 0; i < kSteps; ++i) {
    const double share = 1.0 - (i + 0.5) / kSteps;
    const float from = top + (bottom - top) * static_cast<float>(i) / kSteps;
    const float to = top + (bottom - top) * static_cast<float>(i + 1) / kSteps;
    list.AddRectFilled({corner.x, from}, {corner.x + width, to + 0.5F},
                       to_u32(scale.colour(scale.low + share * (scale.high - scale.low))));
  }
  const AxisMap map{
      {scale.low, scale.high}, AxisScale::kLinear, static_cast<double>(bottom), static_cast<double>(top)};
  const int most = std::max(2, static_cast<int>((bottom - top) / (30.0F * frame.scale)));
  for (const AxisTick& tick : linear_ticks(map.range, most)) {
    if (!tick.major) continue;
    const auto y = static_cast<float>(map.to_pixel(tick.value));
    list.AddLine({corner.x + width, y}, {corner.x + width + 4.0F * frame.scale, y},
                 to_u32(frame.theme.text_dim));
    small_text(frame, {corner.x + width + 7.0F * frame.scale, y - 0.5F * frame.fonts.small->FontSize},
               tick.label, frame.theme.text);
  }
  if (!scale.none.empty()) {
    const float y = corner.y + height - line;
    list.AddRectFilled({corner.x, y}, {corner.x + width, y + width}, to_u32(scale.none_colour));
    list.AddRect({corner.x, y}, {corner.x + width, y + width}, to_u32(frame.theme.border));
    small_text(frame, {corner.x + width + 7.0F * frame.scale, y}, scale.none, frame.theme.text);
  }
  ImGui::Dummy({colour_scale_width(frame), height});
}

Rgb diverging_colour(const Theme& theme, double value) {
  const bool dark = theme.name == ThemeName::kDark;
  const Rgb middle = dark ? Rgb{0x1E, 0x21, 0x27} : Rgb{0xF4, 0xF5, 0xF7};
  const Rgb low = dark ? okabe_ito::kSkyBlue : okabe_ito::kBlue;
  const Rgb high = dark ? okabe_ito::kOrange : okabe_ito::kVermillion;
  const auto share = static_cast<float>(std::clamp(std::abs(value), 0.0, 1.0));
  return mix(middle, value < 0.0 ? low : high, share);
}

Rgb no_value_colour(const Theme& theme) {
  return theme.name == ThemeName::kDark ? Rgb{0x3A, 0x3F, 0x48} : Rgb{0xD2, 0xD6, 0xDC};
}

ImVec2 draw_label(const UiFrame& frame, ImVec2 at, const std::string& text, Rgb colour) {
  const ImVec2 extent = small_extent(frame, text);
  const float pad = 4.0F * frame.scale;
  const ImVec2 size{extent.x + 2.0F * pad, extent.y + 0.5F * pad};
  at = {std::round(at.x), std::round(at.y)};
  ImGui::GetWindowDrawList()->AddRectFilled(at, {at.x + size.x, at.y + size.y},
                                            to_u32(frame.theme.background, 0.82F), 3.0F * frame.scale);
  small_text(frame, {at.x + pad, at.y + 0.25F * pad}, text, colour);
  return size;
}

float draw_badge(const UiFrame& frame, ImVec2 corner, const std::string& text, Rgb ground) {
  const ImVec2 extent = small_extent(frame, text);
  const float pad = 5.0F * frame.scale;
  const ImVec2 high{std::round(corner.x), std::round(corner.y + extent.y + pad)};
  const ImVec2 low{high.x - extent.x - 2.0F * pad, high.y - extent.y - pad};
  // Colours are light in the dark theme, and dark in the light one.
  const Rgb ink = frame.theme.name == ThemeName::kDark ? okabe_ito::kBlack : Rgb{0xFF, 0xFF, 0xFF};
  ImGui::GetWindowDrawList()->AddRectFilled(low, high, to_u32(ground), 3.0F * frame.scale);
  small_text(frame, {low.x + pad, low.y + 0.5F * pad}, text, ink);
  return high.x - low.x;
}

}  // namespace stillpoint
