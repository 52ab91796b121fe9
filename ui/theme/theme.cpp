#include "ui/theme/theme.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"

namespace stillpoint {
namespace {

constexpr Theme kDark{
    .name = ThemeName::kDark,
    .background = {0x11, 0x13, 0x17},
    .panel = {0x18, 0x1B, 0x21},
    .raised = {0x24, 0x29, 0x31},
    .hovered = {0x30, 0x37, 0x42},
    .border = {0x2C, 0x32, 0x3C},
    .text = {0xE4, 0xE8, 0xEE},
    .text_dim = {0x8C, 0x96, 0xA5},
    .accent = {0x4D, 0x9D, 0xE0},
    .plot = {0x12, 0x15, 0x1A},
    .grid = {0x2A, 0x30, 0x3A},
};

constexpr Theme kLight{
    .name = ThemeName::kLight,
    .background = {0xE6, 0xE9, 0xED},
    .panel = {0xF8, 0xF9, 0xFB},
    .raised = {0xE7, 0xEB, 0xF0},
    .hovered = {0xD7, 0xDE, 0xE7},
    .border = {0xCC, 0xD3, 0xDC},
    .text = {0x1C, 0x21, 0x29},
    .text_dim = {0x60, 0x6B, 0x79},
    .accent = {0x1F, 0x6F, 0xB8},
    .plot = {0xFF, 0xFF, 0xFF},
    .grid = {0xE3, 0xE7, 0xEC},
};

void apply_spacing(ImGuiStyle& style) {
  style.WindowPadding = {10, 8};
  style.FramePadding = {8, 4};
  style.CellPadding = {6, 3};
  style.ItemSpacing = {8, 6};
  style.ItemInnerSpacing = {6, 4};
  style.IndentSpacing = 16;
  style.ScrollbarSize = 11;
  style.GrabMinSize = 10;
  style.WindowBorderSize = 1;
  style.ChildBorderSize = 1;
  style.PopupBorderSize = 1;
  style.FrameBorderSize = 0;
  style.TabBorderSize = 0;
  style.WindowRounding = 6;
  style.ChildRounding = 6;
  style.FrameRounding = 4;
  style.PopupRounding = 6;
  style.ScrollbarRounding = 6;
  style.GrabRounding = 4;
  style.TabRounding = 4;
  style.WindowTitleAlign = {0.0F, 0.5F};
  style.WindowMenuButtonPosition = ImGuiDir_None;
}

}  // namespace

const Theme& theme(ThemeName name) { return name == ThemeName::kDark ? kDark : kLight; }

ThemeName parse_theme(std::string_view name) {
  if (name == "dark") return ThemeName::kDark;
  if (name == "light") return ThemeName::kLight;
  throw InputError(fmt::format("there is no theme '{}'; the themes are dark and light", name));
}

ImVec4 to_vec4(Rgb colour, float alpha) {
  return {static_cast<float>(colour.r) / 255.0F, static_cast<float>(colour.g) / 255.0F,
          static_cast<float>(colour.b) / 255.0F, alpha};
}

ImU32 to_u32(Rgb colour, float alpha) {
  return IM_COL32(colour.r, colour.g, colour.b, static_cast<int>(std::lround(255.0F * alpha)));
}

Rgb mix(Rgb a, Rgb b, float share) {
  const auto channel = [share](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(
        std::lround(static_cast<float>(from) + share * (static_cast<float>(to) - static_cast<float>(from))));
  };
  return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b)};
}

void apply_theme(const Theme& theme, float scale) {
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  if (theme.name == ThemeName::kDark)
    ImGui::StyleColorsDark(&style);
  else
    ImGui::StyleColorsLight(&style);
  apply_spacing(style);
  const auto set = [&style](ImGuiCol slot, Rgb colour, float alpha = 1.0F) {
    style.Colors[slot] = to_vec4(colour, alpha);
  };
  set(ImGuiCol_Text, theme.text);
  set(ImGuiCol_TextDisabled, theme.text_dim);
  set(ImGuiCol_WindowBg, theme.panel);
  set(ImGuiCol_ChildBg, theme.panel);
  set(ImGuiCol_PopupBg, mix(theme.panel, theme.raised, 0.4F));
  set(ImGuiCol_Border, theme.border);
  set(ImGuiCol_FrameBg, theme.raised);
  set(ImGuiCol_FrameBgHovered, theme.hovered);
  set(ImGuiCol_FrameBgActive, mix(theme.hovered, theme.accent, 0.25F));
  set(ImGuiCol_TitleBg, theme.panel);
  set(ImGuiCol_TitleBgActive, theme.raised);
  set(ImGuiCol_TitleBgCollapsed, theme.panel);
  set(ImGuiCol_MenuBarBg, theme.background);
  set(ImGuiCol_ScrollbarBg, theme.panel, 0.0F);
  set(ImGuiCol_ScrollbarGrab, theme.hovered);
  set(ImGuiCol_ScrollbarGrabHovered, mix(theme.hovered, theme.text_dim, 0.4F));
  set(ImGuiCol_ScrollbarGrabActive, theme.accent);
  set(ImGuiCol_CheckMark, theme.accent);
  // Numbers are written over it.
  set(ImGuiCol_SliderGrab, mix(theme.raised, theme.accent, 0.5F));
  set(ImGuiCol_SliderGrabActive, mix(theme.raised, theme.accent, 0.75F));
  set(ImGuiCol_Button, theme.raised);
  set(ImGuiCol_ButtonHovered, theme.hovered);
  set(ImGuiCol_ButtonActive, mix(theme.hovered, theme.accent, 0.4F));
  set(ImGuiCol_Header, mix(theme.raised, theme.accent, 0.25F));
  set(ImGuiCol_HeaderHovered, theme.hovered);
  set(ImGuiCol_HeaderActive, mix(theme.hovered, theme.accent, 0.4F));
  set(ImGuiCol_Separator, theme.border);
  set(ImGuiCol_SeparatorHovered, theme.accent);
  set(ImGuiCol_SeparatorActive, theme.accent);
  set(ImGuiCol_Tab, theme.panel);
  set(ImGuiCol_TabHovered, theme.hovered);
  set(ImGuiCol_TabActive, theme.raised);
  set(ImGuiCol_PlotHistogram, theme.accent);
  set(ImGuiCol_TableHeaderBg, theme.raised);
  set(ImGuiCol_TableBorderStrong, theme.border);
  set(ImGuiCol_TableBorderLight, theme.border, 0.6F);
  set(ImGuiCol_TextSelectedBg, theme.accent, 0.35F);
  set(ImGuiCol_NavHighlight, theme.accent);
  set(ImGuiCol_ModalWindowDimBg, Rgb{}, 0.45F);
  style.ScaleAllSizes(scale);
}

}  // namespace stillpoint
