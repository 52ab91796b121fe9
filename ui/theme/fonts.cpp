#include "ui/theme/fonts.hpp"

#include <imgui_freetype.h>

#include <cmath>

#include "ui/theme/icons.hpp"

// Laid down by embedded_fonts.S.
extern "C" {
extern const unsigned char stillpoint_font_regular[], stillpoint_font_regular_end[];
extern const unsigned char stillpoint_font_semibold[], stillpoint_font_semibold_end[];
extern const unsigned char stillpoint_font_mono[], stillpoint_font_mono_end[];
extern const unsigned char stillpoint_font_icons[], stillpoint_font_icons_end[];
}

namespace stillpoint {
namespace {

constexpr float kTextSize = 15.0F;     // design px: of most text …
constexpr float kSmallSize = 12.5F;    // … of footers and legends
constexpr float kHeadingSize = 21.0F;  // … of pages' headings
constexpr float kMonoSize = 14.0F;     // … of numbers, as high as text beside them

// Latin with its supplements, Greek, punctuation, super- and subscripts, arrows, mathematics, simple shapes.
constexpr ImWchar kTextRanges[] = {0x0020, 0x017F, 0x0370, 0x03FF, 0x2010, 0x203A, 0x2070, 0x209F,
                                   0x2190, 0x2199, 0x21BA, 0x21BB, 0x21E7, 0x21E7, 0x2200, 0x2265,
                                   0x2318, 0x2318, 0x25A0, 0x25CF, 0x2713, 0x2717, 0};
constexpr ImWchar kIconRanges[] = {icons::kFirst, icons::kLast, 0};

struct Face {
  const unsigned char* begin;
  const unsigned char* end;
};

ImFont* add(const Face& face, float size, const ImWchar* ranges, bool merge = false, float lower = 0.0F) {
  ImFontConfig config;
  // The bytes are part of the program; the atlas must not free them.
  config.FontDataOwnedByAtlas = false;
  config.MergeMode = merge;
  config.OversampleH = config.OversampleV = 1;
  config.PixelSnapH = true;
  config.GlyphOffset.y = lower;
  config.FontBuilderFlags = ImGuiFreeTypeBuilderFlags_LightHinting;
  // ImGui takes a plain pointer and, not owning the data, only reads it.
  auto* data = const_cast<unsigned char*>(face.begin);
  return ImGui::GetIO().Fonts->AddFontFromMemoryTTF(data, static_cast<int>(face.end - face.begin), size,
                                                    &config, ranges);
}

}  // namespace

FontBytes text_font() {
  return {stillpoint_font_regular,
          static_cast<std::size_t>(stillpoint_font_regular_end - stillpoint_font_regular)};
}

Fonts load_fonts(float scale) {
  const Face regular{stillpoint_font_regular, stillpoint_font_regular_end};
  const Face semibold{stillpoint_font_semibold, stillpoint_font_semibold_end};
  const Face mono{stillpoint_font_mono, stillpoint_font_mono_end};
  const Face icon{stillpoint_font_icons, stillpoint_font_icons_end};
  // Whole pixels keep the baselines of all faces on the pixel grid.
  const auto size = [scale](float design) { return std::round(design * scale); };
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  atlas.FontBuilderIO = ImGuiFreeType::GetBuilderForFreeType();
  const auto add_with_icons = [&](const Face& face, float design) {
    ImFont* font = add(face, size(design), kTextRanges);
    add(icon, size(design * 0.95F), kIconRanges, true, std::round(scale));
    return font;
  };
  Fonts fonts;
  fonts.text = add_with_icons(regular, kTextSize);
  fonts.strong = add_with_icons(semibold, kTextSize);
  fonts.heading = add_with_icons(semibold, kHeadingSize);
  fonts.small = add_with_icons(regular, kSmallSize);
  fonts.mono = add(mono, size(kMonoSize), kTextRanges);
  atlas.Build();
  ImGui::GetIO().FontDefault = fonts.text;
  return fonts;
}

}  // namespace stillpoint
