#include "ui/theme/text.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

namespace stillpoint {
namespace {

float width_of(const ImFont& font, const std::string& text) {
  return font.CalcTextSizeA(font.FontSize, 1e6F, 0.0F, text.c_str()).x;
}

}  // namespace

std::string cut_to(const ImFont& font, const std::string& text, float width) {
  if (width_of(font, text) <= width) return text;
  const std::string ellipsis = "…";
  std::string cut = text;
  do {
    // Never in the middle of a UTF-8 letter.
    while (!cut.empty() && (static_cast<unsigned char>(cut.back()) & 0xC0U) == 0x80U) cut.pop_back();
    if (!cut.empty()) cut.pop_back();
  } while (!cut.empty() && width_of(font, cut + ellipsis) > width);
  return cut.empty() ? cut : cut + ellipsis;
}

std::string in_lines(const ImFont& font, const std::string& text, float width) {
  // ImGui would part 0.81 at its point. A figure keeps its unit.
  constexpr std::size_t kLongestUnit = 4;  // bytes, "°)."
  std::string lines, line;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = std::min(text.find(' ', at), text.size());
    const std::size_t next = std::min(text.find(' ', end + 1), text.size());
    const bool figure = end > at && std::isdigit(static_cast<unsigned char>(text[end - 1])) != 0;
    if (end < text.size() && figure && next - end - 1 <= kLongestUnit) end = next;
    const std::string word = text.substr(at, end - at);
    if (at > 0 && width_of(font, line + ' ' + word) > width)
      lines += std::exchange(line, word) + '\n';
    else
      line += (at > 0 ? " " : "") + word;
    at = end + 1;
  }
  return lines + line;
}

float widest_word(const ImFont& font, const std::string& text) {
  float widest = 0.0F;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    widest = std::max(widest, width_of(font, text.substr(at, end - at)));
    at = end + 1;
  }
  return widest;
}

}  // namespace stillpoint
