#pragma once

#include <imgui.h>

#include <cstddef>

namespace stillpoint {

/// The faces of the interface, at the current scale. They belong to ImGui's font atlas.
struct Fonts {
  ImFont* text = nullptr;     ///< Inter, with the icons of icons.hpp: what most is written in
  ImFont* strong = nullptr;   ///< Inter SemiBold, with icons: names of panels, what matters
  ImFont* heading = nullptr;  ///< Inter SemiBold, larger: the start page, dialogs
  ImFont* small = nullptr;    ///< Inter, smaller: axes, legends, captions
  ImFont* mono = nullptr;     ///< JetBrains Mono: numbers in columns, paths, keys
};

/// A font's file, part of the program.
struct FontBytes {
  const unsigned char* begin = nullptr;
  std::size_t size = 0;
};

/// Inter, what most is written in.
[[nodiscard]] FontBytes text_font();

/// Fills the current ImGui context's atlas anew with the embedded fonts, `scale` times their design size.
[[nodiscard]] Fonts load_fonts(float scale);

}  // namespace stillpoint
