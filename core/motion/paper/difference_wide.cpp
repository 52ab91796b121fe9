#include "core/motion/paper/difference_wide.hpp"

#if defined(__x86_64__)
#include "core/avx2.hpp"

namespace stillpoint {
namespace {

constexpr int kPixels = 32;  // at once

STILLPOINT_AVX2 inline __m256i pixels_at(const unsigned char* from) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
}

STILLPOINT_AVX2 inline __m256i every_other(const unsigned char* from) {
  return _mm256_and_si256(pixels_at(from), _mm256_set1_epi16(0xFF));
}

STILLPOINT_AVX2 inline __m256i times(__m256i gray, short factor) {
  return _mm256_mullo_epi16(gray, _mm256_set1_epi16(factor));
}

STILLPOINT_AVX2 inline int sum_of(__m256i counts) {
  const __m256i pairs = _mm256_madd_epi16(counts, _mm256_set1_epi16(1));
  const __m128i four = _mm_add_epi32(_mm256_castsi256_si128(pairs), _mm256_extracti128_si256(pairs, 1));
  const __m128i two = _mm_add_epi32(four, _mm_unpackhi_epi64(four, four));
  return _mm_cvtsi128_si32(_mm_add_epi32(two, _mm_shuffle_epi32(two, 1)));
}

}  // namespace

STILLPOINT_AVX2 int count_ratios_wide(const unsigned char* to, const unsigned char* from,
                                      const unsigned char* usable, int width, RatioCounts& counts) {
  const __m256i zero = _mm256_setzero_si256();
  __m256i all = zero, darker = zero, brighter = zero;
  int x = 0;
  for (; x + kPixels <= width; x += kPixels) {
    const __m256i a = every_other(to + x), b = every_other(from + x);
    const __m256i least = _mm256_min_epi16(a, b), most = _mm256_max_epi16(a, b);
    const __m256i is_mid = _mm256_and_si256(_mm256_cmpgt_epi16(least, _mm256_set1_epi16(kDark - 1)),
                                            _mm256_cmpgt_epi16(_mm256_set1_epi16(kBright + 1), most));
    // From half as bright on, to less than twice.
    const __m256i is_near = _mm256_andnot_si256(_mm256_cmpgt_epi16(b, _mm256_slli_epi16(a, 1)),
                                                _mm256_cmpgt_epi16(_mm256_slli_epi16(b, 1), a));
    const __m256i untold = _mm256_cmpeq_epi16(every_other(usable + x), zero);
    const __m256i tells = _mm256_andnot_si256(untold, _mm256_and_si256(is_mid, is_near));
    const __m256i fifty = times(a, 50);
    const __m256i is_darker = _mm256_cmpgt_epi16(times(b, 49), fifty);       // less than 0.98
    const __m256i is_less_bright = _mm256_cmpgt_epi16(times(b, 51), fifty);  // less than 1.02
    all = _mm256_sub_epi16(all, tells);                                      // a mask is -1
    darker = _mm256_sub_epi16(darker, _mm256_and_si256(tells, is_darker));
    brighter = _mm256_sub_epi16(brighter, _mm256_andnot_si256(is_less_bright, tells));
  }
  counts.all += sum_of(all);
  counts.darker += sum_of(darker);
  counts.brighter += sum_of(brighter);
  return x;
}

STILLPOINT_AVX2 int differences_wide(const unsigned char* there, const unsigned char* carried,
                                     const unsigned char* usable, int width, unsigned char* to) {
  int x = 0;
  for (; x + kPixels <= width; x += kPixels) {
    const __m256i a = pixels_at(there + x), b = pixels_at(carried + x);
    const __m256i apart = _mm256_or_si256(_mm256_subs_epu8(a, b), _mm256_subs_epu8(b, a));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + x), _mm256_and_si256(apart, pixels_at(usable + x)));
  }
  return x;
}

STILLPOINT_AVX2 int binarise_wide(const unsigned char* pixels, int width, unsigned char least,
                                  unsigned char* to) {
  const __m256i bound = _mm256_set1_epi8(static_cast<char>(least));
  int x = 0;
  for (; x + kPixels <= width; x += kPixels) {
    const __m256i own = pixels_at(pixels + x);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + x),
                        _mm256_cmpeq_epi8(_mm256_max_epu8(own, bound), own));
  }
  return x;
}

}  // namespace stillpoint
#endif
