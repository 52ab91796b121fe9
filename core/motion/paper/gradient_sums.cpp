#if defined(__x86_64__)
#include <algorithm>

#include "core/motion/paper/window_lanes.hpp"

namespace stillpoint {
namespace {

/// Sums of dx², dx·dy and dy² in whole numbers: in each half two lanes of dx² (of dx·dy), then two of dy².
struct WholeSums {
  __m256i squares{}, products{};
};

/// @param gradients in each half x of four pixels, then y
STILLPOINT_AVX2 inline void add_to(WholeSums& sums, __m256i gradients) {
  const __m256i turned = _mm256_shuffle_epi32(gradients, 0x4E);  // y, then x
  sums.squares = _mm256_add_epi32(sums.squares, _mm256_madd_epi16(gradients, gradients));
  sums.products = _mm256_add_epi32(sums.products, _mm256_madd_epi16(gradients, turned));
}

/// Sums over a window, as floats.
struct FloatSums {
  float xx = 0.0F, xy = 0.0F, yy = 0.0F;
};

/// Of lanes: ((lane 0 + lane 2) + (lane 1 + lane 3)).
STILLPOINT_AVX2 inline FloatSums sums_of_lanes(__m256 squares, __m256 products) {
  alignas(16) std::array<float, 4> square, product;
  _mm_store_ps(square.data(), add_halves(squares));
  _mm_store_ps(product.data(), add_halves(products));
  return {square[0] + square[1], product[0] + product[1], square[2] + square[3]};
}

/// Sums of the laned pixels, and of the others.
struct RoundedSums {
  FloatSums laned, rest;
};

/// Adds the products of eight pixels to lanes: those of the first four, then those of the others.
STILLPOINT_AVX2 inline void add_rounded(__m256i pairs, __m256& squares, __m256& products) {
  const __m256 first = _mm256_cvtepi32_ps(_mm256_srai_epi32(_mm256_slli_epi32(pairs, 16), 16));
  const __m256 second = _mm256_cvtepi32_ps(_mm256_srai_epi32(pairs, 16));
  squares = _mm256_add_ps(_mm256_add_ps(squares, _mm256_mul_ps(first, first)), _mm256_mul_ps(second, second));
  products = _mm256_add_ps(_mm256_add_ps(products, _mm256_mul_ps(first, _mm256_permute_ps(first, 0x4E))),
                           _mm256_mul_ps(second, _mm256_permute_ps(second, 0x4E)));
}

/// Adds the products of a row's other pixels, one after the other.
STILLPOINT_AVX2 inline void add_rounded(const std::array<std::int16_t, 16>& gradients, FloatSums& sums) {
  const __m256 four = _mm256_cvtepi32_ps(
      _mm256_cvtepi16_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(gradients.data()))));
  alignas(32) std::array<float, 8> squares;
  alignas(16) std::array<float, 4> products;
  _mm256_store_ps(squares.data(), _mm256_mul_ps(four, four));
  _mm_store_ps(products.data(), _mm_mul_ps(_mm256_castps256_ps128(four), _mm256_extractf128_ps(four, 1)));
  for (std::size_t k = 0; k < 4; ++k) {
    sums.xx += squares[k];
    sums.xy += products[k];
    sums.yy += squares[4 + k];
  }
  const float dx = gradients[kRestX[4]], dy = gradients[kRestY[4]];
  sums.xx += dx * dx;
  sums.xy += dx * dy;
  sums.yy += dy * dy;
}

/// Sums rounded to a float at each step, in OpenCV's order.
STILLPOINT_AVX2 RoundedSums rounded_sums(const Window& window) {
  __m256 squares = _mm256_setzero_ps(), products = squares;
  FloatSums rest;
  for (const WindowRow& row : window.rows) {
    add_rounded(load(row.laned_gradient[0]), squares, products);
    add_rounded(load(row.laned_gradient[1]), squares, products);
    add_rounded(row.rest_gradient, rest);
  }
  return {sums_of_lanes(squares, products), rest};
}

}  // namespace

STILLPOINT_AVX2 GradientSums sum_gradients(const Window& window) {
  WholeSums laned, rest;
  for (const WindowRow& row : window.rows) {
    add_to(laned, load(row.laned_gradient[0]));
    add_to(laned, load(row.laned_gradient[1]));
    add_to(rest, load(row.rest_gradient));
  }
  alignas(16) std::array<std::int32_t, 4> square, product;
  _mm_store_si128(reinterpret_cast<__m128i*>(square.data()), add_halves(rest.squares));
  _mm_store_si128(reinterpret_cast<__m128i*>(product.data()), add_halves(rest.products));
  const int xx = square[0] + square[1],
            yy = square[2] + square[3];  // at most 105 times 4080²: 32 bits hold it
  RoundedSums sums;
  // Squares below kExact were so all the way, and products are no more than they.
  if (std::max(xx, yy) < kExact && _mm256_testz_si256(laned.squares, _mm256_set1_epi32(-kExact)) != 0) {
    sums.laned = sums_of_lanes(_mm256_cvtepi32_ps(laned.squares), _mm256_cvtepi32_ps(laned.products));
    sums.rest = {static_cast<float>(xx), static_cast<float>(product[0] + product[1]), static_cast<float>(yy)};
  } else {
    sums = rounded_sums(window);
  }
  return {(sums.rest.xx + sums.laned.xx) * kSumScale, (sums.rest.xy + sums.laned.xy) * kSumScale,
          (sums.rest.yy + sums.laned.yy) * kSumScale, static_cast<float>(std::max(xx, yy))};
}

}  // namespace stillpoint
#endif
