#pragma once

// What the windows of Lucas-Kanade are read and summed by with AVX2; for their own files alone.

#if defined(__x86_64__)
#include <array>
#include <cstddef>

#include "core/avx2.hpp"
#include "core/motion/paper/flow_window.hpp"

namespace stillpoint {

inline constexpr float kSumScale = 1.0F / (1 << 20);  // OpenCV's, of all sums over a window
inline constexpr int kExact = 1 << 24;  // whole numbers below it are floats, and so are their sums

/// Where WindowRow's lists of the rest have its pixels: along x, and along y.
inline constexpr std::array<std::size_t, kRestPixels> kRestX = {0, 1, 2, 3, 8}, kRestY = {4, 5, 6, 7, 12};

template <typename T>
STILLPOINT_AVX2 inline __m256i load(const T& of) {
  return _mm256_load_si256(reinterpret_cast<const __m256i*>(&of));
}
template <typename T>
STILLPOINT_AVX2 inline void store(T& to, __m256i value) {
  _mm256_store_si256(reinterpret_cast<__m256i*>(&to), value);
}

/// The two halves' lanes added.
STILLPOINT_AVX2 inline __m128 add_halves(__m256 sums) {
  return _mm_add_ps(_mm256_castps256_ps128(sums), _mm256_extractf128_ps(sums, 1));
}
STILLPOINT_AVX2 inline __m128i add_halves(__m256i sums) {
  return _mm_add_epi32(_mm256_castsi256_si128(sums), _mm256_extracti128_si256(sums, 1));
}

}  // namespace stillpoint
#endif
