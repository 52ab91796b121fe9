#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/inspect/marks.hpp"

namespace stillpoint {

// Pixels that are watched. A pin stays at its pixel of the target from frame to frame, whatever the camera
// does, so that it shows how one place of the image changes; pictures of the other frame show it where that
// pixel's scene point lies there.

/// The first of A, B, … Z, A1, B1, … that no pin has.
[[nodiscard]] std::string free_pin_name(const std::vector<Pin>& pins);

/// The pin at a pixel, within `radius` px; nothing where there is none.
[[nodiscard]] std::optional<std::size_t> pin_near(const std::vector<Pin>& pins, double x, double y,
                                                  double radius);

/// The pins with one more at the middle of the pixel, or with the one there taken out.
[[nodiscard]] std::vector<Pin> with_pin_toggled(std::vector<Pin> pins, int frame, int x, int y);

}  // namespace stillpoint
