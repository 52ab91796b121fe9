#include "ui/theme/rounded.hpp"

#include <cmath>

namespace stillpoint {

void fill_rounded(ImDrawList& list, ImVec2 low, ImVec2 high, ImU32 colour, float rounding) {
  // A corner is rounded less where its side is short: it needs a pixel more than its radius.
  const float rows = std::ceil(rounding) + 2.0F;
  const auto whole = [](ImVec2 at) { return std::floor(at.x) == at.x && std::floor(at.y) == at.y; };
  // Between pixels its edges are smoothed all along.
  if (!whole(low) || !whole(high) || high.y - low.y <= 2.0F * rows || high.x - low.x <= 2.0F * rows) {
    list.AddRectFilled(low, high, colour, rounding);
    return;
  }
  list.AddRectFilled(low, {high.x, low.y + rows}, colour, rounding, ImDrawFlags_RoundCornersTop);
  list.AddRectFilled({low.x, low.y + rows}, {high.x, high.y - rows}, colour);
  list.AddRectFilled({low.x, high.y - rows}, high, colour, rounding, ImDrawFlags_RoundCornersBottom);
}

}  // namespace stillpoint
