#include "ui/panels/run_look.hpp"

#include <array>

namespace stillpoint {

RunLook ghost_look(const std::vector<GhostView>& ghosts, std::size_t index, ThemeName theme) {
  return ghost_look(ghosts[index].look.value_or(index), theme);
}

RunLook ghost_look(std::size_t number, ThemeName theme) {
  // The estimate's blue, the baseline's orange and the truth's grey are taken.
  const bool dark = theme == ThemeName::kDark;
  const std::array<RunLook, 4> looks{{{okabe_ito::kPurple, SeriesStyle::kDotted, Sign::kCircle, 0.008},
                                      {okabe_ito::kGreen, SeriesStyle::kDashDot, Sign::kDiamond, 0.03},
                                      {okabe_ito::kVermillion, SeriesStyle::kDotted, Sign::kTriangle, 0.016},
                                      {dark ? okabe_ito::kYellow : Rgb{0x8A, 0x7F, 0x00},
                                       SeriesStyle::kDashDot, Sign::kHollowSquare, 0.05}}};
  return looks[number % looks.size()];
}

std::string shortened(const std::string& name, std::size_t most) {
  if (name.size() <= most) return name;
  std::size_t end = most;
  // Never in the middle of a UTF-8 letter.
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0U) == 0x80U) --end;
  return name.substr(0, end) + "…";
}

}  // namespace stillpoint
