#pragma once

namespace stillpoint {

// Rows of frame_difference, exposure_ratio and binarise 32 pixels at once, for processors with AVX2 (x86-64
// alone). Each returns how many of the row's pixels it did, a multiple of 32.

/// Pixels that tell a ratio of grey levels, and those of them whose ratio is too far from 1 to be left
/// untold.
struct RatioCounts {
  int all = 0, darker = 0, brighter = 0;
};

// Grey levels that tell a ratio: coarse steps below, cut off above.
inline constexpr int kDark = 48, kBright = 215;

int count_ratios_wide(const unsigned char* to, const unsigned char* from, const unsigned char* usable,
                      int width, RatioCounts& counts);

int differences_wide(const unsigned char* there, const unsigned char* carried, const unsigned char* usable,
                     int width, unsigned char* to);

/// 255 where a pixel is at least `least`, else 0.
int binarise_wide(const unsigned char* pixels, int width, unsigned char least, unsigned char* to);

}  // namespace stillpoint
