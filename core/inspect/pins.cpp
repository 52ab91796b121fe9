#include "core/inspect/pins.hpp"

#include <algorithm>
#include <cmath>

namespace stillpoint {

std::string free_pin_name(const std::vector<Pin>& pins) {
  for (int i = 0;; ++i) {
    std::string name(1, static_cast<char>('A' + i % 26));
    if (i >= 26) name += std::to_string(i / 26);
    if (std::none_of(pins.begin(), pins.end(), [&](const Pin& pin) { return pin.name == name; })) return name;
  }
}

std::optional<std::size_t> pin_near(const std::vector<Pin>& pins, double x, double y, double radius) {
  std::optional<std::size_t> best;
  double nearest = radius;
  for (std::size_t i = 0; i < pins.size(); ++i) {
    const double away = std::hypot(pins[i].x - x, pins[i].y - y);
    if (away > nearest) continue;
    nearest = away;
    best = i;
  }
  return best;
}

std::vector<Pin> with_pin_toggled(std::vector<Pin> pins, int frame, int x, int y) {
  constexpr double kSamePixel = 0.7;  // px: less than to the next pixel, more than rounding leaves
  if (const auto there = pin_near(pins, x, y, kSamePixel)) {
    pins.erase(pins.begin() + static_cast<std::ptrdiff_t>(*there));
    return pins;
  }
  pins.push_back({frame, static_cast<double>(x), static_cast<double>(y), free_pin_name(pins)});
  return pins;
}

}  // namespace stillpoint
