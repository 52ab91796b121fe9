#pragma once

#include <imgui.h>

#include <string>

namespace stillpoint {

// Text as it fits into a width, px.

/// Whole, or cut and ended by an ellipsis. "" where not even that fits.
[[nodiscard]] std::string cut_to(const ImFont& font, const std::string& text, float width);

/// As lines that end at spaces alone, and never between a figure and its unit.
[[nodiscard]] std::string in_lines(const ImFont& font, const std::string& text, float width);

/// What its longest word needs.
[[nodiscard]] float widest_word(const ImFont& font, const std::string& text);

}  // namespace stillpoint
