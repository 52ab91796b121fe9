#include "core/motion/paper/flow_window.hpp"

#if defined(__x86_64__)
#include <cmath>
#include <cstring>

#include "core/motion/paper/window_lanes.hpp"

namespace stillpoint {
namespace {

// OpenCV's arithmetic: weights and interpolated grey levels are integers, sums are of floats. The first 16
// pixels of a row of the window are summed in four lanes, pixel k with pixel k + 4 of each eight; the others
// one after the other. Which sum a number enters, and when, decides the last bit, and is kept here.
constexpr int kGrayBits = 5;  // interpolated grey levels have five bits behind the point
constexpr int kGrayShift = kWindowWeightBits - kGrayBits;
constexpr float kExactSquared = 0.999F * kExact * kExact;     // with room for what a float is off
constexpr std::size_t kGrayBytes = 32, kGradientBytes = 100;  // read from the first pixel of a row on

/// The bytes of an image from a window's first pixel on, `bytes` of each of its rows and of one below; copied
/// where they would end behind the image's memory.
class WindowBytes {
 public:
  WindowBytes(const cv::Mat& image, const cv::Point& corner, std::size_t bytes)
      : first_(image.data + corner.y * static_cast<std::ptrdiff_t>(image.step) +
               corner.x * static_cast<std::ptrdiff_t>(image.elemSize())),
        step_(static_cast<std::ptrdiff_t>(image.step)) {
    if (first_ + kWindow * step_ + bytes <= image.datalimit) return;
    copy_.fill(0);  // what lies beyond the window counts for nothing, but is read
    for (int y = 0; y <= kWindow; ++y)
      std::memcpy(copy_.data() + y * kCopyStep, row(y), (kWindow + 1) * image.elemSize());
    first_ = copy_.data();
    step_ = kCopyStep;
  }
  WindowBytes(const WindowBytes&) = delete;
  WindowBytes& operator=(const WindowBytes&) = delete;
  [[nodiscard]] const unsigned char* row(int y) const { return first_ + y * step_; }

 private:
  // Bytes a line: kGradientBytes and a few, so that lines begin on whole words.
  static constexpr int kCopyStep = 104;
  const unsigned char* first_;
  std::ptrdiff_t step_;
  std::array<unsigned char, (kWindow + 1) * kCopyStep> copy_;
};

STILLPOINT_AVX2 inline __m256i load_bytes(const unsigned char* from) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
}

/// Each pixel of a line beside its right neighbour, in 16 bits each.
struct Line {
  __m256i first, second;  ///< pixels 0 to 3 and 8 to 11, 4 to 7 and 12 to 15
  __m256i rest;           ///< pixels 16 to 23
};

STILLPOINT_AVX2 inline __m256i sixteen(const unsigned char* from) {
  return _mm256_broadcastsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from)));
}

STILLPOINT_AVX2 inline Line line_at(const unsigned char* row) {
  const __m256i of_eights = _mm256_setr_epi8(0, -1, 1, -1, 1, -1, 2, -1, 2, -1, 3, -1, 3, -1, 4, -1,  //
                                             8, -1, 9, -1, 9, -1, 10, -1, 10, -1, 11, -1, 11, -1, 12, -1);
  const __m256i in_order = _mm256_setr_epi8(0, -1, 1, -1, 1, -1, 2, -1, 2, -1, 3, -1, 3, -1, 4, -1,  //
                                            4, -1, 5, -1, 5, -1, 6, -1, 6, -1, 7, -1, 7, -1, 8, -1);
  return {_mm256_shuffle_epi8(sixteen(row), of_eights), _mm256_shuffle_epi8(sixteen(row + 4), of_eights),
          _mm256_shuffle_epi8(sixteen(row + kLanedPixels), in_order)};
}

struct Weights {
  __m256i upper, lower;
};

STILLPOINT_AVX2 inline Weights weights_of(const WindowPlace& place) {
  return {_mm256_set1_epi32(place.upper_weights), _mm256_set1_epi32(place.lower_weights)};
}

/// Pairs weighed and summed, before they are shifted back.
STILLPOINT_AVX2 inline __m256i weigh(__m256i upper, __m256i lower, const Weights& weights, __m256i half) {
  return _mm256_add_epi32(_mm256_add_epi32(_mm256_madd_epi16(upper, weights.upper), half),
                          _mm256_madd_epi16(lower, weights.lower));
}

/// Interpolated grey levels of a row, ordered as in WindowRow.
struct GrayRow {
  __m256i laned, rest;
};

/// Each four of eight numbers twice, in 16 bits.
STILLPOINT_AVX2 inline __m256i fours_twice(__m256i eight) { return _mm256_packs_epi32(eight, eight); }

STILLPOINT_AVX2 inline GrayRow gray_between(const Line& upper, const Line& lower, const Weights& weights) {
  const __m256i half = _mm256_set1_epi32(1 << (kGrayShift - 1));
  const __m256i first = weigh(upper.first, lower.first, weights, half);
  const __m256i second = weigh(upper.second, lower.second, weights, half);
  return {_mm256_blend_epi16(_mm256_srli_epi32(first, kGrayShift), _mm256_slli_epi32(second, 16 - kGrayShift),
                             0xAA),
          fours_twice(_mm256_srli_epi32(weigh(upper.rest, lower.rest, weights, half), kGrayShift))};
}

/// Gradients of eight pixels beside their right neighbours': dx of two pixels, dy of two, … in 32 bits each.
struct GradientLine {
  __m256i even, odd;  ///< of pixels 0 1 4 5, and 2 3 6 7
};

STILLPOINT_AVX2 inline GradientLine gradient_line_at(const unsigned char* from) {
  const __m256i here = load_bytes(from), right = load_bytes(from + 4);
  return {_mm256_unpacklo_epi16(here, right), _mm256_unpackhi_epi16(here, right)};
}

/// Interpolated gradients of eight pixels: dx of pixel 0, dy, dx of pixel 1, …
STILLPOINT_AVX2 inline __m256i gradients_between(const GradientLine& upper, const GradientLine& lower,
                                                 const Weights& weights) {
  const __m256i half = _mm256_set1_epi32(1 << (kWindowWeightBits - 1));
  return _mm256_packs_epi32(
      _mm256_srai_epi32(weigh(upper.even, lower.even, weights, half), kWindowWeightBits),
      _mm256_srai_epi32(weigh(upper.odd, lower.odd, weights, half), kWindowWeightBits));
}

STILLPOINT_AVX2 inline void store_laned(std::array<std::int16_t, 16>& to, __m256i gradients) {
  const __m256i by_lanes = _mm256_setr_epi8(0, 1, 8, 9, 4, 5, 12, 13, 2, 3, 10, 11, 6, 7, 14, 15,  //
                                            0, 1, 8, 9, 4, 5, 12, 13, 2, 3, 10, 11, 6, 7, 14, 15);
  store(to, _mm256_shuffle_epi8(_mm256_permute4x64_epi64(gradients, 0xD8), by_lanes));
}

STILLPOINT_AVX2 inline void store_rest(WindowRow& row, __m256i gradients) {
  const __m256i in_window = _mm256_setr_epi8(0, 1, 4, 5, 8, 9, 12, 13, 2, 3, 6, 7, 10, 11, 14, 15,  //
                                             0, 1, -1, -1, -1, -1, -1, -1, 2, 3, -1, -1, -1, -1, -1, -1);
  store(row.rest_gradient, _mm256_shuffle_epi8(gradients, in_window));
}

STILLPOINT_AVX2 void interpolate_window(const WindowBytes& gray, const WindowBytes& change,
                                        const Weights& weights, Window& window) {
  Line upper = line_at(gray.row(0));
  for (int y = 0; y < kWindow; ++y) {
    WindowRow& row = window.rows[static_cast<std::size_t>(y)];
    const Line lower = line_at(gray.row(y + 1));
    const GrayRow levels = gray_between(upper, lower, weights);
    store(row.laned_gray, levels.laned);
    store(row.rest_gray, levels.rest);
    upper = lower;
  }
  GradientLine first = gradient_line_at(change.row(0)), second = gradient_line_at(change.row(0) + 32);
  for (int y = 0; y < kWindow; ++y) {
    WindowRow& row = window.rows[static_cast<std::size_t>(y)];
    const GradientLine first_below = gradient_line_at(change.row(y + 1));
    store_laned(row.laned_gradient[0], gradients_between(first, first_below, weights));
    first = first_below;
    const GradientLine second_below = gradient_line_at(change.row(y + 1) + 32);
    store_laned(row.laned_gradient[1], gradients_between(second, second_below, weights));
    second = second_below;
  }
  GradientLine rest = gradient_line_at(change.row(0) + 64);
  for (int y = 0; y < kWindow; ++y) {
    const GradientLine rest_below = gradient_line_at(change.row(y + 1) + 64);
    store_rest(window.rows[static_cast<std::size_t>(y)], gradients_between(rest, rest_below, weights));
    rest = rest_below;
  }
}

/// The same for a window that lies on whole pixels, as a corner's does in the full image.
STILLPOINT_AVX2 void copy_window(const WindowBytes& gray, const WindowBytes& change, Window& window) {
  const __m256i low_half = _mm256_set1_epi32(0xFFFF);
  for (int y = 0; y < kWindow; ++y) {
    WindowRow& row = window.rows[static_cast<std::size_t>(y)];
    const Line line = line_at(gray.row(y));
    const __m256i laned = _mm256_blend_epi16(line.first, _mm256_slli_epi32(line.second, 16), 0xAA);
    store(row.laned_gray, _mm256_slli_epi16(laned, kGrayBits));
    store(row.rest_gray, fours_twice(_mm256_slli_epi32(_mm256_and_si256(line.rest, low_half), kGrayBits)));
    store_laned(row.laned_gradient[0], load_bytes(change.row(y)));
    store_laned(row.laned_gradient[1], load_bytes(change.row(y) + 32));
    store_rest(row, load_bytes(change.row(y) + 64));
  }
}

/// Differences of the pixels that are summed one after the other, ordered as in WindowRow.
struct alignas(32) Differences {
  std::array<std::array<std::int16_t, 16>, kWindow> rows;
};

/// Sums of differences times gradients in order, each rounded to a float.
cv::Point2f sum_in_order(const Differences& differences, const Window& window) {
  cv::Point2f sum;
  for (std::size_t y = 0; y < kWindow; ++y)
    for (std::size_t k = 0; k < kRestPixels; ++k) {
      const int off = differences.rows[y][kRestX[k]];
      sum.x += static_cast<float>(off * window.rows[y].rest_gradient[kRestX[k]]);
      sum.y += static_cast<float>(off * window.rows[y].rest_gradient[kRestY[k]]);
    }
  return sum;
}

/// Whether no sum of the rest's differences times gradients reaches kExact on the way: by Cauchy and Schwarz
/// it is at most the root of the product of their squares' sums.
/// @param squares differences', twice in each half; those of more than 31 bits show by their sign
STILLPOINT_AVX2 inline bool are_exact(__m256i squares, float rest_most) {
  if (_mm256_movemask_ps(_mm256_castsi256_ps(squares)) != 0) return false;
  const __m128 both = add_halves(_mm256_cvtepi32_ps(squares));
  return (_mm_cvtss_f32(both) + _mm_cvtss_f32(_mm_movehdup_ps(both))) * rest_most < kExactSquared;
}

/// The same by what sums came to at each row, and what the row's own could add at most, where that bound is
/// too wide.
STILLPOINT_AVX2 bool are_exact(const Differences& differences, const Window& window) {
  __m128i sums = _mm_setzero_si128(), most = sums;  // along x, along y
  for (std::size_t y = 0; y < kWindow; ++y) {
    const __m256i off = load(differences.rows[y]), gradient = load(window.rows[y].rest_gradient);
    const __m256i sizes = _mm256_madd_epi16(_mm256_abs_epi16(off), _mm256_abs_epi16(gradient));
    const __m128i row = _mm_hadd_epi32(add_halves(_mm256_madd_epi16(off, gradient)), add_halves(sizes));
    most = _mm_or_si128(most, _mm_add_epi32(_mm_abs_epi32(sums), _mm_unpackhi_epi64(row, row)));
    sums = _mm_add_epi32(sums, row);
  }
  return _mm_testz_si128(most, _mm_setr_epi32(-kExact, -kExact, 0, 0)) != 0;
}

}  // namespace

STILLPOINT_AVX2 void fill_window(const cv::Mat& image, const cv::Mat& gradients, const WindowPlace& place,
                                 Window& window) {
  const WindowBytes gray(image, place.corner, kGrayBytes);
  const WindowBytes change(gradients, place.corner, kGradientBytes);
  for (int y = 0; y <= kWindow; ++y) {  // all rows at once, ahead of the grey levels' work
    __builtin_prefetch(change.row(y));
    __builtin_prefetch(change.row(y) + 64);
  }
  if (place.is_on_pixels())
    copy_window(gray, change, window);
  else
    interpolate_window(gray, change, weights_of(place), window);
}

STILLPOINT_AVX2 cv::Point2f mismatch(const Window& window, float rest_most, const cv::Mat& image,
                                     const WindowPlace& place) {
  const WindowBytes gray(image, place.corner, kGrayBytes);
  const Weights weights = weights_of(place);
  Differences differences;
  __m256 laned = _mm256_setzero_ps();  // in each half two lanes along x, two along y
  __m256i rest = _mm256_setzero_si256(), squares = rest;
  Line upper = line_at(gray.row(0));
  for (int y = 0; y < kWindow; ++y) {
    const WindowRow& row = window.rows[static_cast<std::size_t>(y)];
    const Line lower = line_at(gray.row(y + 1));
    const GrayRow levels = gray_between(upper, lower, weights);
    upper = lower;
    const __m256i off = _mm256_sub_epi16(levels.laned, load(row.laned_gray));
    const __m256i first = _mm256_permute4x64_epi64(off, 0x50), second = _mm256_permute4x64_epi64(off, 0xFA);
    laned = _mm256_add_ps(laned, _mm256_cvtepi32_ps(_mm256_madd_epi16(first, load(row.laned_gradient[0]))));
    laned = _mm256_add_ps(laned, _mm256_cvtepi32_ps(_mm256_madd_epi16(second, load(row.laned_gradient[1]))));
    const __m256i rest_off = _mm256_sub_epi16(levels.rest, load(row.rest_gray));
    store(differences.rows[static_cast<std::size_t>(y)], rest_off);
    rest = _mm256_add_epi32(rest, _mm256_madd_epi16(rest_off, load(row.rest_gradient)));
    squares = _mm256_add_epi32(squares, _mm256_madd_epi16(rest_off, rest_off));
  }
  alignas(16) std::array<float, 4> lanes;
  _mm_store_ps(lanes.data(), add_halves(laned));
  cv::Point2f sum;
  if (are_exact(squares, rest_most) || are_exact(differences, window)) {  // the same in any order
    alignas(16) std::array<std::int32_t, 4> sums;
    _mm_store_si128(reinterpret_cast<__m128i*>(sums.data()), add_halves(rest));
    sum = {static_cast<float>(sums[0] + sums[1]), static_cast<float>(sums[2] + sums[3])};
  } else {
    sum = sum_in_order(differences, window);
  }
  return {(sum.x + (lanes[0] + lanes[1])) * kSumScale, (sum.y + (lanes[2] + lanes[3])) * kSumScale};
}

STILLPOINT_AVX2 float mean_difference(const Window& window, const cv::Mat& image, const WindowPlace& place) {
  const WindowBytes gray(image, place.corner, kGrayBytes);
  const Weights weights = weights_of(place);
  const __m256i ones = _mm256_set1_epi16(1);
  const __m256i in_window = _mm256_setr_epi16(1, 1, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0);
  __m256i sum = _mm256_setzero_si256();
  Line upper = line_at(gray.row(0));
  for (int y = 0; y < kWindow; ++y) {
    const WindowRow& row = window.rows[static_cast<std::size_t>(y)];
    const Line lower = line_at(gray.row(y + 1));
    const GrayRow levels = gray_between(upper, lower, weights);
    upper = lower;
    const __m256i off = _mm256_abs_epi16(_mm256_sub_epi16(levels.laned, load(row.laned_gray)));
    const __m256i rest = _mm256_abs_epi16(_mm256_sub_epi16(levels.rest, load(row.rest_gray)));
    sum = _mm256_add_epi32(sum, _mm256_madd_epi16(off, ones));
    sum = _mm256_add_epi32(sum, _mm256_madd_epi16(rest, in_window));
  }
  alignas(32) std::array<std::int32_t, 8> lanes;
  store(lanes, sum);
  int whole = 0;  // at most 21² times 255 << 5: a float holds it
  for (const int lane : lanes) whole += lane;
  return static_cast<float>(whole) / static_cast<float>(32 * kWindow * kWindow);
}

}  // namespace stillpoint
#endif
