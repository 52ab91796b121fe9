#include "core/motion/paper/corner_candidates.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/avx2.hpp"

namespace stillpoint {
namespace {

constexpr int kLanes = 8;  // pixels at once

/// The gradient matrix along a row: dx², dx·dy and dy² of every pixel, or sums of them.
struct MatrixRow {
  explicit MatrixRow(int width)
      : xx(static_cast<std::size_t>(width)),
        xy(static_cast<std::size_t>(width)),
        yy(static_cast<std::size_t>(width)) {}
  std::vector<float> xx, xy, yy;
};

using MatrixRows = std::array<MatrixRow, 3>;

#if defined(__x86_64__)

/// Keeps a number of eight pixels, and adds it to those of the two other rows.
template <bool kIsThird>
STILLPOINT_AVX2 inline void keep_and_add(__m256 own, const float* a, const float* b, float* keep,
                                         float* sum) {
  _mm256_storeu_ps(keep, own);
  const __m256 first = _mm256_loadu_ps(a), second = _mm256_loadu_ps(b);
  _mm256_storeu_ps(sum, kIsThird ? _mm256_add_ps(_mm256_add_ps(first, second), own)
                                 : _mm256_add_ps(_mm256_add_ps(first, own), second));
}

/// fill_row and add_rows in one. @param a,b the other rows in order: the new one lies between them, before
/// them (which is the same to the bit) or, where it is the third, after them
/// @return how many pixels it did
template <bool kIsThird>
STILLPOINT_AVX2 int fill_and_add_eights(const short* gradients, int width, const MatrixRow& a,
                                        const MatrixRow& b, MatrixRow& row, MatrixRow& sum) {
  std::size_t x = 0;
  for (; x + kLanes <= static_cast<std::size_t>(width); x += kLanes) {
    const __m256i both = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(gradients + 2 * x));
    const __m256 dx = _mm256_cvtepi32_ps(_mm256_srai_epi32(_mm256_slli_epi32(both, 16), 16));
    const __m256 dy = _mm256_cvtepi32_ps(_mm256_srai_epi32(both, 16));
    keep_and_add<kIsThird>(_mm256_mul_ps(dx, dx), &a.xx[x], &b.xx[x], &row.xx[x], &sum.xx[x]);
    keep_and_add<kIsThird>(_mm256_mul_ps(dx, dy), &a.xy[x], &b.xy[x], &row.xy[x], &sum.xy[x]);
    keep_and_add<kIsThird>(_mm256_mul_ps(dy, dy), &a.yy[x], &b.yy[x], &row.yy[x], &sum.yy[x]);
  }
  return static_cast<int>(x);
}

STILLPOINT_AVX2 inline __m256 with_neighbours(const float* sums) {
  return _mm256_add_ps(_mm256_add_ps(_mm256_loadu_ps(sums - 1), _mm256_loadu_ps(sums)),
                       _mm256_loadu_ps(sums + 1));
}

/// Responses from the second pixel on. @return the first pixel it did not reach
STILLPOINT_AVX2 int respond_eights(const MatrixRow& sum, int width, float* response, float& largest) {
  __m256 most = _mm256_set1_ps(largest);
  int x = 1;
  for (; x + kLanes < width; x += kLanes) {
    const auto at = static_cast<std::size_t>(x);
    const __m256 a = with_neighbours(&sum.xx[at]), b = with_neighbours(&sum.xy[at]);
    const __m256 c = with_neighbours(&sum.yy[at]);
    const __m256 apart = _mm256_sub_ps(a, c);
    const __m256 four_b = _mm256_mul_ps(_mm256_set1_ps(4.0F), b);
    const __m256 root = _mm256_sqrt_ps(_mm256_add_ps(_mm256_mul_ps(apart, apart), _mm256_mul_ps(four_b, b)));
    const __m256 twice = _mm256_sub_ps(_mm256_add_ps(a, c), root);
    _mm256_storeu_ps(response + x, twice);
    most = _mm256_max_ps(most, twice);
  }
  alignas(32) std::array<float, kLanes> lanes;
  _mm256_store_ps(lanes.data(), most);
  largest = *std::max_element(lanes.begin(), lanes.end());
  return x;
}

STILLPOINT_AVX2 inline __m256 no_less(__m256 own, const float* than) {
  return _mm256_cmp_ps(own, _mm256_loadu_ps(than), _CMP_GE_OQ);
}

STILLPOINT_AVX2 inline __m256 no_less_than_three(__m256 own, const float* row) {
  return _mm256_and_ps(no_less(own, row), _mm256_and_ps(no_less(own, row - 1), no_less(own, row + 1)));
}

/// Which of eight pixels are at least `least`, and no less than their eight neighbours: a bit each.
STILLPOINT_AVX2 inline unsigned maxima_of_eight(const float* above, const float* here, const float* below,
                                                float least) {
  const __m256 own = _mm256_loadu_ps(here);
  const __m256 in_row =
      _mm256_and_ps(_mm256_cmp_ps(own, _mm256_set1_ps(least), _CMP_GE_OQ), no_less_than_three(own, here));
  if (_mm256_movemask_ps(in_row) == 0) return 0;
  const __m256 beside = _mm256_and_ps(no_less_than_three(own, above), no_less_than_three(own, below));
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_and_ps(in_row, beside)));
}

#endif

/// Fills rows[slot] from a row of gradients and adds all three up: a + b + c in the rows' order.
void fill_and_add(const short* gradients, int width, MatrixRows& rows, std::size_t slot, MatrixRow& sum,
                  [[maybe_unused]] bool wide) {
  MatrixRow& row = rows[slot];
  int x = 0;
#if defined(__x86_64__)
  if (wide)
    x = slot == 2 ? fill_and_add_eights<true>(gradients, width, rows[0], rows[1], row, sum)
                  : fill_and_add_eights<false>(gradients, width, rows[1 - slot], rows[2], row, sum);
#endif
  float *xx = row.xx.data(), *xy = row.xy.data(), *yy = row.yy.data();
  for (int k = x; k < width; ++k) {
    const float dx = gradients[2 * k], dy = gradients[2 * k + 1];
    xx[k] = dx * dx;
    xy[k] = dx * dy;
    yy[k] = dy * dy;
  }
  const auto add = [x, &rows, &sum, width](std::vector<float> MatrixRow::*numbers) {
    const float *a = (rows[0].*numbers).data(), *b = (rows[1].*numbers).data(),
                *c = (rows[2].*numbers).data();
    float* to = (sum.*numbers).data();
    for (int k = x; k < width; ++k) to[k] = a[k] + b[k] + c[k];
  };
  add(&MatrixRow::xx);
  add(&MatrixRow::xy);
  add(&MatrixRow::yy);
}

/// Twice the smaller eigenvalue at every pixel of a row but the outermost two, which stay as they are.
/// @param largest raised to the largest of them
void respond(const MatrixRow& sum, int width, float* response, float& largest, [[maybe_unused]] bool wide) {
  int x = 1;
#if defined(__x86_64__)
  if (wide) x = respond_eights(sum, width, response, largest);
#endif
  const float *xx = sum.xx.data(), *xy = sum.xy.data(), *yy = sum.yy.data();
  for (; x < width - 1; ++x) {
    const float a = xx[x - 1] + xx[x] + xx[x + 1];
    const float b = xy[x - 1] + xy[x] + xy[x + 1];
    const float c = yy[x - 1] + yy[x] + yy[x + 1];
    response[x] = a + c - std::sqrt((a - c) * (a - c) + 4.0F * b * b);
    largest = std::max(largest, response[x]);
  }
}

/// Responses of three rows that follow each other.
struct ThreeRows {
  const float *above, *here, *below;
};

/// Local maxima as one number each, so that the strongest and first is the least: a response above 0 has the
/// order of its bits.
class Candidates {
 public:
  void add(float response, std::uint32_t pixel) {
    keys_.push_back(std::uint64_t{~std::bit_cast<std::uint32_t>(response)} << 32 | pixel);
  }
  /// Leaves those of at least `least`, in order.
  void sort_from(float least) {
    const auto is_less = [least](std::uint64_t key) { return response_of(key) < least; };
    keys_.erase(std::remove_if(keys_.begin(), keys_.end(), is_less), keys_.end());
    std::sort(keys_.begin(), keys_.end());
  }
  [[nodiscard]] std::vector<CornerCandidate> list(int width) const {
    std::vector<CornerCandidate> list;
    list.reserve(keys_.size());
    for (const std::uint64_t key : keys_) {
      const auto pixel = static_cast<std::uint32_t>(key), across = static_cast<std::uint32_t>(width);
      list.push_back(
          {{static_cast<int>(pixel % across), static_cast<int>(pixel / across)}, response_of(key)});
    }
    return list;
  }

 private:
  static float response_of(std::uint64_t key) {
    return std::bit_cast<float>(~static_cast<std::uint32_t>(key >> 32));
  }

  std::vector<std::uint64_t> keys_;
};

/// Scalar, from pixel x on.
void add_maxima_from(int x, const ThreeRows& rows, int width, float least, std::uint32_t first_pixel,
                     Candidates& found) {
  const auto [above, here, below] = rows;
  for (; x < width - 1; ++x) {
    if (here[x] < least || here[x] < here[x - 1] || here[x] < here[x + 1]) continue;
    if (here[x] >= std::max({above[x - 1], above[x], above[x + 1], below[x - 1], below[x], below[x + 1]}))
      found.add(here[x], first_pixel + static_cast<std::uint32_t>(x));
  }
}

#if defined(__x86_64__)
STILLPOINT_AVX2 void add_maxima_wide(const ThreeRows& rows, int width, float least, std::uint32_t first_pixel,
                                     Candidates& found) {
  int x = 1;
  for (; x + kLanes < width; x += kLanes)
    for (unsigned maxima = maxima_of_eight(rows.above + x, rows.here + x, rows.below + x, least); maxima != 0;
         maxima &= maxima - 1) {
      const int at = x + std::countr_zero(maxima);
      found.add(rows.here[at], first_pixel + static_cast<std::uint32_t>(at));
    }
  add_maxima_from(x, rows, width, least, first_pixel, found);
}
#endif

void add_maxima(const ThreeRows& rows, int width, float least, std::uint32_t first_pixel, Candidates& found,
                [[maybe_unused]] bool wide) {
#if defined(__x86_64__)
  if (wide) return add_maxima_wide(rows, width, least, first_pixel, found);
#endif
  add_maxima_from(1, rows, width, least, first_pixel, found);
}

}  // namespace

std::vector<CornerCandidate> corner_candidates(const cv::Mat& gradients, double quality, bool wide) {
  const int width = gradients.cols, height = gradients.rows;
  if (width < 3 || height < 3) return {};
  MatrixRows rows = {MatrixRow(width), MatrixRow(width), MatrixRow(width)};
  MatrixRow sum(width);
  const auto slot = [](int y) { return static_cast<std::size_t>(y % 3); };
  std::array<std::vector<float>, 3> responses;
  for (auto& row : responses) row.assign(static_cast<std::size_t>(width), 0.0F);

  float largest = 0.0F;  // so far: what is weaker than its share cannot be strong enough in the end
  const auto least = [&] { return static_cast<float>(quality * static_cast<double>(largest)); };
  Candidates found;
  for (int y = 0; y < height; ++y) {
    // Row y takes row y-3's place; the order of the three does not matter but for rounding, which it fixes.
    fill_and_add(gradients.ptr<short>(y), width, rows, slot(y), sum, wide);
    if (y < 2) continue;
    respond(sum, width, responses[slot(y - 1)].data(), largest, wide);
    const int judged = y - 2;  // the row before, which has both its neighbours now
    if (judged < 1 || largest <= 0.0F) continue;
    add_maxima({responses[slot(judged - 1)].data(), responses[slot(judged)].data(),
                responses[slot(judged + 1)].data()},
               width, least(), static_cast<std::uint32_t>(judged) * static_cast<std::uint32_t>(width), found,
               wide);
  }
  if (largest <= 0.0F) return {};
  const int last = height - 2;
  std::fill(responses[slot(last + 1)].begin(), responses[slot(last + 1)].end(), 0.0F);
  add_maxima(
      {responses[slot(last - 1)].data(), responses[slot(last)].data(), responses[slot(last + 1)].data()},
      width, least(), static_cast<std::uint32_t>(last) * static_cast<std::uint32_t>(width), found, wide);
  found.sort_from(least());
  return found.list(width);
}

}  // namespace stillpoint
