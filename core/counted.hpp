#pragma once

#include <string>

namespace stillpoint {

/// "1 frame", "0 frames", "12 frames": a number before what it counts.
/// @param thing in the singular, whose plural has an s more
template <typename Number>
[[nodiscard]] std::string counted(Number number, const std::string& thing) {
  return std::to_string(number) + " " + thing + (number == Number{1} ? "" : "s");
}

}  // namespace stillpoint
