#pragma once

#include <imgui.h>

#include <string_view>

#include "ui/theme/palette.hpp"

namespace stillpoint {

/// The surfaces and inks of a theme.
struct Theme {
  ThemeName name = ThemeName::kDark;
  Rgb background;  ///< behind everything
  Rgb panel;       ///< a panel's surface
  Rgb raised;      ///< headings, buttons, fields
  Rgb hovered;     ///< what the mouse is over
  Rgb border;      ///< hairlines
  Rgb text;        ///< what is to be read
  Rgb text_dim;    ///< units, axes, hints
  Rgb accent;      ///< the active, the selected
  Rgb plot;        ///< the ground of plots and of the 3-D view
  Rgb grid;        ///< grid lines on it
};

[[nodiscard]] const Theme& theme(ThemeName name);

/// "dark" or "light".
/// @throws InputError for another name.
[[nodiscard]] ThemeName parse_theme(std::string_view name);

/// Gives the current ImGui context the theme's colours and our spacing, at `scale` times its design size.
void apply_theme(const Theme& theme, float scale);

/// A colour as ImGui takes it; alpha 0 to 1.
[[nodiscard]] ImU32 to_u32(Rgb colour, float alpha = 1.0F);
[[nodiscard]] ImVec4 to_vec4(Rgb colour, float alpha = 1.0F);

/// `share` of b mixed into a, channel by channel.
[[nodiscard]] Rgb mix(Rgb a, Rgb b, float share);

}  // namespace stillpoint
