#pragma once

#include "ui/theme/palette.hpp"

namespace stillpoint {

/// Scales of colour for values; all read in order by people with colour vision deficiencies, and in grey
/// print.
enum class Colormap { kViridis, kCividis, kInferno };

/// The colour at `value` from 0 (low) to 1 (high); beyond is clamped, NaN is the low end.
[[nodiscard]] Rgb map_colour(Colormap map, float value);

}  // namespace stillpoint
