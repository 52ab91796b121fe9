#include "core/motion/paper/gray_warp.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "core/avx2.hpp"
#include "core/motion/paper/block_warp.hpp"

namespace stillpoint {
namespace {

#if defined(__x86_64__)

constexpr int kFractionBits = 5, kFractions = 1 << kFractionBits;  // of a pixel
constexpr int kGroup = 8;                                          // pixels at once

/// Whether no pixel of the destination comes from a horizon or from further away than integers reach.
bool is_tame(const cv::Matx33d& source_from_destination, const cv::Size& size) {
  const double right = size.width - 1, bottom = size.height - 1;
  const double sign = source_from_destination(2, 2) < 0 ? -1.0 : 1.0;
  for (const cv::Vec3d& corner : {cv::Vec3d(0, 0, 1), {right, 0, 1}, {0, bottom, 1}, {right, bottom, 1}}) {
    const cv::Vec3d at = source_from_destination * corner;
    if (!(at[2] * sign > 1e-9) || !(std::abs(at[0] / at[2]) < 1e6) || !(std::abs(at[1] / at[2]) < 1e6))
      return false;
  }
  return true;
}

class GrayWarp {
 public:
  /// @param source_from_destination row by row
  GrayWarp(const cv::Mat& source, const std::array<double, 9>& source_from_destination)
      : source_(source), m_(source_from_destination) {}

  STILLPOINT_AVX2 void fill(cv::Mat& destination) const {
    // The sums for a block's first pixel are made anew at each block, as OpenCV does: last bits depend on it.
    const int block = std::min(1024 / std::min(16, destination.rows), destination.cols);
    const BlockWarp near(source_, m_);
    const bool by_groups = block <= BlockWarp::kBlock && can_warp_blocks();
    for (int y = 0; y < destination.rows; ++y)
      for (int x = 0; x < destination.cols; x += block) {
        const WarpedRow row{m_[0] * x + m_[1] * y + m_[2], m_[3] * x + m_[4] * y + m_[5],
                            m_[6] * x + m_[7] * y + m_[8]};
        const int count = std::min(block, destination.cols - x);
        unsigned char* to = destination.ptr(y, x);
        const unsigned filled = by_groups ? near.fill(row, {x, y}, count, to) : 0;
        if (filled == 0) {
          fill_pixels(row, 0, count, to);
          continue;
        }
        for (int k = 0; k < count; k += BlockWarp::kGroup)
          if ((filled >> (k / BlockWarp::kGroup) & 1) == 0)
            fill_pixels(row, k, std::min(k + BlockWarp::kGroup, count), to);
      }
  }

 private:
  /// Coordinates of eight pixels in the source, 1/32 px.
  struct Places {
    __m256i x, y;
  };

  STILLPOINT_AVX2 static inline __m256d along(double first, double step, __m256d k) {
    return _mm256_add_pd(_mm256_set1_pd(first), _mm256_mul_pd(_mm256_set1_pd(step), k));
  }

  STILLPOINT_AVX2 inline void four_places(const WarpedRow& row, __m256d k, __m128i& x, __m128i& y) const {
    const __m256d scale = _mm256_div_pd(_mm256_set1_pd(kFractions), along(row.w, m_[6], k));
    x = _mm256_cvtpd_epi32(_mm256_mul_pd(along(row.x, m_[0], k), scale));
    y = _mm256_cvtpd_epi32(_mm256_mul_pd(along(row.y, m_[3], k), scale));
  }

  STILLPOINT_AVX2 inline Places places(const WarpedRow& row, int first) const {
    const __m256d k = _mm256_add_pd(_mm256_set1_pd(first), _mm256_setr_pd(0, 1, 2, 3));
    __m128i x0, y0, x1, y1;
    four_places(row, k, x0, y0);
    four_places(row, _mm256_add_pd(k, _mm256_set1_pd(4)), x1, y1);
    return {_mm256_set_m128i(x1, x0), _mm256_set_m128i(y1, y0)};
  }

  /// @param begin,end pixels of the block, the first a multiple of kGroup
  STILLPOINT_AVX2 void fill_pixels(const WarpedRow& row, int begin, int end, unsigned char* to) const {
    for (int k = begin; k < end; k += kGroup) {
      const Places from = places(row, k);
      if (k + kGroup <= end && fill_eight(from, to + k)) continue;
      if (k + kGroup <= end && all_beyond(from)) {
        std::memset(to + k, 0, kGroup);
        continue;
      }
      alignas(32) std::array<int, kGroup> x, y;
      _mm256_store_si256(reinterpret_cast<__m256i*>(x.data()), from.x);
      _mm256_store_si256(reinterpret_cast<__m256i*>(y.data()), from.y);
      for (int i = 0; i < std::min(kGroup, end - k); ++i)
        to[k + i] = pixel(x[static_cast<std::size_t>(i)], y[static_cast<std::size_t>(i)]);
    }
  }

  /// Whether eight pixels have no part in the source.
  STILLPOINT_AVX2 inline bool all_beyond(const Places& from) const {
    const __m256i x = _mm256_srai_epi32(from.x, kFractionBits), y = _mm256_srai_epi32(from.y, kFractionBits);
    const __m256i before_first = _mm256_set1_epi32(-1);
    const __m256i beyond =
        _mm256_or_si256(_mm256_or_si256(_mm256_cmpgt_epi32(before_first, x),
                                        _mm256_cmpgt_epi32(x, _mm256_set1_epi32(source_.cols - 1))),
                        _mm256_or_si256(_mm256_cmpgt_epi32(before_first, y),
                                        _mm256_cmpgt_epi32(y, _mm256_set1_epi32(source_.rows - 1))));
    return _mm256_movemask_ps(_mm256_castsi256_ps(beyond)) == 0xFF;
  }

  /// @return false where one of the eight comes from beyond the source's rim, or from close to its end
  STILLPOINT_AVX2 inline bool fill_eight(const Places& from, unsigned char* to) const {
    const __m256i x = _mm256_srai_epi32(from.x, kFractionBits), y = _mm256_srai_epi32(from.y, kFractionBits);
    const __m256i outside = _mm256_or_si256(
        _mm256_or_si256(x, _mm256_cmpgt_epi32(x, _mm256_set1_epi32(source_.cols - 2))),
        _mm256_or_si256(y, _mm256_cmpgt_epi32(y, _mm256_set1_epi32(source_.rows - kRowsReadOf))));
    if (_mm256_movemask_ps(_mm256_castsi256_ps(outside)) != 0) return false;

    const __m256i fraction = _mm256_set1_epi32(kFractions - 1);
    const __m256i right = _mm256_and_si256(from.x, fraction), lower = _mm256_and_si256(from.y, fraction);
    // The left pixel's weight and the right one's in a byte each; the upper and lower line's in 16 bits.
    const __m256i sideways =
        _mm256_or_si256(_mm256_sub_epi32(_mm256_set1_epi32(kFractions), right), _mm256_slli_epi32(right, 8));
    const __m256i downwards =
        _mm256_or_si256(_mm256_sub_epi32(_mm256_set1_epi32(kFractions), lower), _mm256_slli_epi32(lower, 16));
    const Pairs pairs = pairs_at(x, y);
    const __m256i above = _mm256_maddubs_epi16(pairs.above, sideways);
    const __m256i below = _mm256_maddubs_epi16(pairs.below, sideways);
    const __m256i sum = _mm256_madd_epi16(_mm256_or_si256(above, _mm256_slli_epi32(below, 16)), downwards);
    const __m256i gray =
        _mm256_srli_epi32(_mm256_add_epi32(sum, _mm256_set1_epi32(kHalf)), 2 * kFractionBits);
    const __m128i words = _mm_packs_epi32(_mm256_castsi256_si128(gray), _mm256_extracti128_si256(gray, 1));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(to), _mm_packus_epi16(words, words));
    return true;
  }

  /// Pixels and their right neighbours, of one line and the one below: in the lower 16 bits of 32.
  struct Pairs {
    __m256i above, below;
  };

  STILLPOINT_AVX2 inline Pairs pairs_at(__m256i x, __m256i y) const {
    const __m256i step = _mm256_set1_epi32(static_cast<int>(source_.step));
    const __m256i at = _mm256_add_epi32(_mm256_mullo_epi32(y, step), x);
    const int first = _mm_cvtsi128_si32(_mm256_castsi256_si128(at));
    const __m256i beside =
        _mm256_add_epi32(_mm256_set1_epi32(first), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
    const __m256i apart = _mm256_xor_si256(at, beside);
    if (_mm256_testz_si256(apart, apart) != 0)  // nearly always: a camera hardly turns between two frames
      return {neighbours(source_.data + first), neighbours(source_.data + first + source_.step)};
    const __m256i two_bytes = _mm256_set1_epi32(0xFFFF);
    const int* data = reinterpret_cast<const int*>(source_.data);
    return {_mm256_and_si256(_mm256_i32gather_epi32(data, at, 1), two_bytes),
            _mm256_and_si256(_mm256_i32gather_epi32(data, _mm256_add_epi32(at, step), 1), two_bytes)};
  }

  STILLPOINT_AVX2 static inline __m256i neighbours(const unsigned char* line) {
    const __m128i here = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(line));
    const __m128i right = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(line + 1));
    return _mm256_cvtepu16_epi32(_mm_unpacklo_epi8(here, right));
  }

  [[nodiscard]] unsigned char pixel(int x, int y) const {
    const int left = x >> kFractionBits, top = y >> kFractionBits;
    const int right_weight = x & (kFractions - 1), lower_weight = y & (kFractions - 1);
    const auto gray = [this](int column, int row) {
      const bool inside = column >= 0 && row >= 0 && column < source_.cols && row < source_.rows;
      return inside ? static_cast<int>(source_.at<unsigned char>(row, column)) : 0;
    };
    const auto line = [&](int row) {
      return (kFractions - right_weight) * gray(left, row) + right_weight * gray(left + 1, row);
    };
    return static_cast<unsigned char>(
        ((kFractions - lower_weight) * line(top) + lower_weight * line(top + 1) + kHalf) >>
        (2 * kFractionBits));
  }

  static constexpr int kRowsReadOf = 3;  // four bytes are read of two lines: a third one has those at the end
  static constexpr int kHalf = 1 << (2 * kFractionBits - 1);  // of the products' last place, for rounding
  const cv::Mat& source_;
  const std::array<double, 9>& m_;
};

#endif

}  // namespace

cv::Mat warp_gray(const cv::Mat& source, const cv::Matx33d& homography) {
  cv::Mat destination;
#if defined(__x86_64__)
  static const bool has_avx2 = cv::checkHardwareSupport(CV_CPU_AVX2);
  cv::Matx33d back;
  cv::invert(homography, back);
  if (has_avx2 && is_tame(back, source.size())) {
    destination.create(source.size(), CV_8UC1);
    const std::array<double, 9> rows = std::to_array(back.val);
    GrayWarp(source, rows).fill(destination);
    return destination;
  }
#endif
  cv::warpPerspective(source, destination, homography, source.size(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return destination;
}

}  // namespace stillpoint
