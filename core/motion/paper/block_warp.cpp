#include "core/motion/paper/block_warp.hpp"

#if defined(__x86_64__)
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/avx2.hpp"

namespace stillpoint {
namespace {

constexpr int kPartBits = 5, kParts = 1 << kPartBits;  // of a pixel: what coordinates are rounded to
constexpr int kFineBits = 16;                          // behind those
constexpr double kFine = kParts << kFineBits;          // a pixel
constexpr double kMiddle = BlockWarp::kBlock / 2;      // of a block: polynomials are about it
// Where depth bends by no more along half a block, what the polynomial leaves out is 2^-14 of a 1/32 px.
constexpr double kMostBend = 1.0 / 256;
// px by which shifts drift along half a block: then floats are good to 2^-14 of a 1/32 px, and what eight
// pixels need of a line lies within 16 bytes.
constexpr double kMostDrift = 3.0;
constexpr int kDoubtBits =
    4;                     // of kFineBits: 2^-12 of a 1/32 px from where rounding turns, all is computed anew
constexpr int kSpare = 4;  // px read before a group's own shift
constexpr int kBytesRead = 8 + 16;  // of a line: sixteen bytes for each half of a group

/// How far a block's pixels are shifted along one axis: whole pixels, the same for all, and a polynomial in
/// the place from the block's middle on, of kFine a pixel.
struct Shift {
  /// @param at the middle's shift, px @param stretch px in the source a pixel, there
  /// @param own px by which places move a pixel @param bend share by which depth changes a pixel
  Shift(double at, double stretch, double own, double bend)
      : whole(static_cast<int>(std::floor(at))),
        drift(kMiddle * (std::abs(stretch - own) + 2.0 * kMiddle * std::abs(stretch * bend))) {
    const double half = 0.5 / kParts;  // rounding to the nearest 1/32 px
    fine = {static_cast<float>((at - whole + half) * kFine), static_cast<float>((stretch - own) * kFine),
            static_cast<float>(-stretch * bend * kFine), static_cast<float>(stretch * bend * bend * kFine)};
  }
  int whole;
  double drift;  ///< no pixel is shifted by more from the middle's, px
  std::array<float, 4> fine;
};

/// Shifts of sixteen pixels, in order.
struct Shifts {
  __m256i parts;  ///< 1/32 px in 16 bits each, without the whole pixels
  __m256i doubt;  ///< 0 where rounding is in doubt
};

STILLPOINT_AVX2_FMA inline __m256i fine_shifts(const Shift& shift, __m256 place) {
  __m256 sum = _mm256_set1_ps(shift.fine[3]);
  sum = _mm256_fmadd_ps(sum, place, _mm256_set1_ps(shift.fine[2]));
  sum = _mm256_fmadd_ps(sum, place, _mm256_set1_ps(shift.fine[1]));
  return _mm256_cvtps_epi32(_mm256_fmadd_ps(sum, place, _mm256_set1_ps(shift.fine[0])));
}

STILLPOINT_AVX2_FMA inline Shifts shifts_at(const Shift& shift, __m256 even_places, __m256 odd_places) {
  const __m256i even = fine_shifts(shift, even_places), odd = fine_shifts(shift, odd_places);
  const __m256i rest = _mm256_blend_epi16(even, _mm256_slli_epi32(odd, kFineBits), 0xAA);
  const __m256i from_turn = _mm256_add_epi16(rest, _mm256_set1_epi16(1 << kDoubtBits));
  return {_mm256_blend_epi16(_mm256_srli_epi32(even, kFineBits), odd, 0xAA),
          _mm256_srli_epi16(from_turn, kDoubtBits + 1)};
}

/// What sixteen pixels are read by.
struct Reading {
  __m256i pairs;     ///< of each pixel and its right neighbour, in the sixteen bytes of its half
  __m256i sideways;  ///< their weights, a byte each
};

/// Each pixel of a line weighed with its right neighbour.
STILLPOINT_AVX2_FMA inline __m256i weighed(const unsigned char* line, const Reading& reading) {
  const __m256i bytes =
      _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(line))),
                              _mm_loadu_si128(reinterpret_cast<const __m128i*>(line + 8)), 1);
  return _mm256_maddubs_epi16(_mm256_shuffle_epi8(bytes, reading.pairs), reading.sideways);
}

/// (32 - lower) · above + lower · below, rounded and shifted back: as 32 · above + lower · (below - above).
STILLPOINT_AVX2_FMA inline __m256i between(__m256i above, __m256i below, __m256i lower) {
  const __m256i more = _mm256_slli_epi16(_mm256_sub_epi16(below, above), 2);
  const __m256i part = _mm256_mulhi_epi16(more, _mm256_slli_epi16(lower, 16 - kPartBits - 2));
  return _mm256_srli_epi16(_mm256_add_epi16(_mm256_add_epi16(above, part), _mm256_set1_epi16(kParts / 2)),
                           kPartBits);
}

/// A block's shifts, and the images it is carried between.
struct Block {
  const cv::Mat& source;
  Shift x, y;
  cv::Point first;
};

/// Whether all sixteen bytes and their neighbours lie in the image, where not all that is read lies in the
/// line.
STILLPOINT_AVX2_FMA bool lie_inside(const Block& block, const cv::Point& from, __m256i beyond) {
  const cv::Mat& source = block.source;
  const auto step = static_cast<std::ptrdiff_t>(source.step);
  if (from.x < -kBytesRead || from.x > source.cols || source.cols > INT16_MAX) return false;
  if (from.y * step + from.x < 0 ||
      (from.y + 2) * step + from.x + kBytesRead > (source.rows - 1) * step + source.cols)
    return false;
  const __m256i in_group = _mm256_setr_epi16(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const __m256i column =
      _mm256_add_epi16(_mm256_add_epi16(beyond, in_group), _mm256_set1_epi16(static_cast<short>(from.x)));
  const __m256i outside =
      _mm256_or_si256(_mm256_srai_epi16(column, 15),
                      _mm256_cmpgt_epi16(column, _mm256_set1_epi16(static_cast<short>(source.cols - 2))));
  return _mm256_testz_si256(outside, outside) != 0;
}

STILLPOINT_AVX2_FMA inline bool fill_group(const Block& block, int k, unsigned char* to) {
  const __m256 even = _mm256_add_ps(_mm256_setr_ps(0, 2, 4, 6, 8, 10, 12, 14),
                                    _mm256_set1_ps(static_cast<float>(k - kMiddle)));
  const __m256 odd = _mm256_add_ps(even, _mm256_set1_ps(1.0F));
  const Shifts x = shifts_at(block.x, even, odd), y = shifts_at(block.y, even, odd);

  // Sideways a shift may be any that kSpare holds, downwards one of two that follow each other.
  const __m256i beyond = _mm256_add_epi16(_mm256_srai_epi16(x.parts, kPartBits), _mm256_set1_epi16(kSpare));
  const __m256i down = _mm256_srai_epi16(y.parts, kPartBits);
  const auto first_down = static_cast<std::int16_t>(_mm256_extract_epi16(down, 0));
  const auto last_down = static_cast<std::int16_t>(_mm256_extract_epi16(down, 15));
  const int least_down = std::min(first_down, last_down);
  const __m256i next_line = _mm256_sub_epi16(down, _mm256_set1_epi16(static_cast<short>(least_down)));
  const __m256i zero = _mm256_setzero_si256();
  const __m256i in_doubt = _mm256_cmpeq_epi16(_mm256_min_epu16(x.doubt, y.doubt), zero);
  const __m256i too_far = _mm256_or_si256(_mm256_srli_epi16(beyond, 3), _mm256_srli_epi16(next_line, 1));
  const __m256i left_out = _mm256_or_si256(in_doubt, too_far);
  if (_mm256_testz_si256(left_out, left_out) == 0) return false;

  const cv::Point from(block.first.x + k + block.x.whole - kSpare,
                       block.first.y + block.y.whole + least_down);
  if (from.y < 0 || from.y + 2 >= block.source.rows) return false;
  if ((from.x < 0 || from.x + kBytesRead > block.source.cols) && !lie_inside(block, from, beyond))
    return false;

  const __m256i part = _mm256_set1_epi16(kParts - 1);
  const __m256i right = _mm256_and_si256(x.parts, part), lower = _mm256_and_si256(y.parts, part);
  const __m256i in_half = _mm256_setr_epi8(0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8,  //
                                           0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8);
  const Reading reading{
      _mm256_add_epi8(in_half, _mm256_mullo_epi16(beyond, _mm256_set1_epi16(0x0101))),
      _mm256_add_epi16(_mm256_mullo_epi16(right, _mm256_set1_epi16(255)), _mm256_set1_epi16(kParts))};
  const auto step = static_cast<std::ptrdiff_t>(block.source.step);
  const unsigned char* line = block.source.data + from.y * step + from.x;
  const __m256i first = weighed(line, reading), second = weighed(line + step, reading);
  const __m256i third = weighed(line + 2 * step, reading);
  const __m256i is_next = _mm256_sub_epi16(zero, next_line);
  const __m256i gray =
      between(_mm256_blendv_epi8(first, second, is_next), _mm256_blendv_epi8(second, third, is_next), lower);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(to),
                   _mm_packus_epi16(_mm256_castsi256_si128(gray), _mm256_extracti128_si256(gray, 1)));
  return true;
}

}  // namespace

bool can_warp_blocks() {
  static const bool can = cv::checkHardwareSupport(CV_CPU_AVX2) && cv::checkHardwareSupport(CV_CPU_FMA3);
  return can;
}

STILLPOINT_AVX2_FMA unsigned BlockWarp::fill(const WarpedRow& row, const cv::Point& first, int count,
                                             unsigned char* to) const {
  const double nearness = 1.0 / (row.w + kMiddle * m_[6]), bend = m_[6] * nearness;
  if (count > kBlock || !(std::abs(bend) * kMiddle <= kMostBend)) return 0;
  // (x + m0·k) / (w + m6·k) is, u pixels from the middle on, its value there and stretch · u / (1 + bend ·
  // u).
  const double x = (row.x + kMiddle * m_[0]) * nearness, y = (row.y + kMiddle * m_[3]) * nearness;
  const Block block{source_, Shift(x - first.x - kMiddle, m_[0] * nearness - x * bend, 1.0, bend),
                    Shift(y - first.y, m_[3] * nearness - y * bend, 0.0, bend), first};
  if (block.x.drift > kMostDrift || block.y.drift > kMostDrift) return 0;
  unsigned filled = 0;
  for (int k = 0; k + kGroup <= count; k += kGroup)
    if (fill_group(block, k, to + k)) filled |= 1U << (k / kGroup);
  return filled;
}

}  // namespace stillpoint
#endif
