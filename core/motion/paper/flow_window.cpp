#include "core/motion/paper/flow_window.hpp"

#if defined(__x86_64__)
#include <cmath>
#include <cstring>

#include "core/avx2.hpp"

namespace stillpoint {
namespace {

// OpenCV's arithmetic: weights and interpolated grey levels are integers, sums are of floats. The first 16
// pixels of a row of the window are summed in four lanes, pixel k with pixel k + 4 of each eight; the others
// one after the other. Which sum a number enters, and when, decides the last bit, and is kept here.
constexpr int kGrayBits = 5;  // interpolated grey levels have five bits behind the point
constexpr int kGrayShift = kWindowWeightBits - kGrayBits;
constexpr float kSumScale = 1.0F / (1 << 20);
constexpr int kExact = 1 << 24;  // whole numbers below it are floats, and so are their sums
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

template <typename T>
STILLPOINT_AVX2 inline __m256i load(const T& of) {
  return _mm256_load_si256(reinterpret_cast<const __m256i*>(&of));
}
template <typename T>
STILLPOINT_AVX2 inline void store(T& to, __m256i value) {
  _mm256_store_si256(reinterpret_cast<__m256i*>(&to), value);
}
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

STILLPOINT_AVX2 inline GrayRow gray_between(const Line& upper, const Line& lower, const Weights& weights) {
  const __m256i half = _mm256_set1_epi32(1 << (kGrayShift - 1));
  const __m256i first = weigh(upper.first, lower.first, weights, half);
  const __m256i second = weigh(upper.second, lower.second, weights, half);
  return {_mm256_blend_epi16(_mm256_srli_epi32(first, kGrayShift), _mm256_slli_epi32(second, 16 - kGrayShift),
                             0xAA),
          _mm256_srli_epi32(weigh(upper.rest, lower.rest, weights, half), kGrayShift)};
}

/// Gradients of eight pixels beside their right neighbours': dx of two pixels, dy of two, … in 32 bits each.
struct GradientLine {
  __m256i even, odd;  ///< of pixels 0 1 4 5, and 2 3 6 7
};

STILLPOINT_AVX2 inline GradientLine gradient_line_at(const unsigned char* from) {
  const __m256i here = load_bytes(from), right = load_bytes(from + 4);
  return {_mm256_unpacklo_epi16(here, right), _mm256_unpackhi_epi16(here, right)};
}

/// Interpolated gradients of eight pixels, in order.
struct Gradients {
  __m256i dx, dy;
};

STILLPOINT_AVX2 inline Gradients gradients_between(const GradientLine& upper, const GradientLine& lower,
                                                   const Weights& weights) {
  const __m256i half = _mm256_set1_epi32(1 << (kWindowWeightBits - 1));
  const __m256 even =
      _mm256_castsi256_ps(_mm256_srai_epi32(weigh(upper.even, lower.even, weights, half), kWindowWeightBits));
  const __m256 odd =
      _mm256_castsi256_ps(_mm256_srai_epi32(weigh(upper.odd, lower.odd, weights, half), kWindowWeightBits));
  return {_mm256_castps_si256(_mm256_shuffle_ps(even, odd, 0x88)),
          _mm256_castps_si256(_mm256_shuffle_ps(even, odd, 0xDD))};
}

/// Eight numbers as pairs of 16 bits: 0 4 1 5 2 6 3 7.
STILLPOINT_AVX2 inline __m128i lane_pairs(__m256i numbers) {
  return _mm_blend_epi16(_mm256_castsi256_si128(numbers),
                         _mm_slli_epi32(_mm256_extracti128_si256(numbers, 1), 16), 0xAA);
}

/// ((lane 0 + lane 2) + (lane 1 + lane 3)).
STILLPOINT_AVX2 inline float sum_of_lanes(__m128 lanes) {
  const __m128 two = _mm_add_ps(lanes, _mm_movehl_ps(lanes, lanes));
  return _mm_cvtss_f32(_mm_add_ss(two, _mm_movehdup_ps(two)));
}

STILLPOINT_AVX2 inline __m128 add_halves(__m128 sum, __m256 eight) {
  return _mm_add_ps(_mm_add_ps(sum, _mm256_castps256_ps128(eight)), _mm256_extractf128_ps(eight, 1));
}

/// Sums of dx², dx·dy and dy² in lanes.
struct LanedSums {
  __m128 xx = _mm_setzero_ps(), xy = _mm_setzero_ps(), yy = _mm_setzero_ps();
};

STILLPOINT_AVX2 inline void take_laned(const Gradients& eight, std::array<std::int16_t, 16>& to,
                                       LanedSums& sums) {
  store(to, _mm256_set_m128i(lane_pairs(eight.dy), lane_pairs(eight.dx)));
  const __m256 dx = _mm256_cvtepi32_ps(eight.dx), dy = _mm256_cvtepi32_ps(eight.dy);
  sums.xx = add_halves(sums.xx, _mm256_mul_ps(dx, dx));
  sums.xy = add_halves(sums.xy, _mm256_mul_ps(dx, dy));
  sums.yy = add_halves(sums.yy, _mm256_mul_ps(dy, dy));
}

/// Sums of dx², dx·dy and dy², one pixel after the other.
struct SumsInOrder {
  float xx = 0.0F, xy = 0.0F, yy = 0.0F;
};

STILLPOINT_AVX2 inline void take_rest(const Gradients& eight, WindowRow& row, SumsInOrder& sums) {
  const __m256i in_window = _mm256_setr_epi32(0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0, 0, 0);
  store(row.dx, _mm256_and_si256(eight.dx, in_window));
  store(row.dy, _mm256_and_si256(eight.dy, in_window));
  const __m256 dx = _mm256_cvtepi32_ps(eight.dx), dy = _mm256_cvtepi32_ps(eight.dy);
  alignas(32) std::array<float, 8> xx, xy, yy;
  _mm256_store_ps(xx.data(), _mm256_mul_ps(dx, dx));
  _mm256_store_ps(xy.data(), _mm256_mul_ps(dx, dy));
  _mm256_store_ps(yy.data(), _mm256_mul_ps(dy, dy));
#pragma GCC unroll 8
  for (std::size_t k = 0; k < kRestPixels; ++k) {
    sums.xx += xx[k];
    sums.xy += xy[k];
    sums.yy += yy[k];
  }
}

/// Sums of a window's gradients, on the way to Window::a11 and so on.
struct WindowSums {
  LanedSums laned;
  SumsInOrder in_order;
};

STILLPOINT_AVX2 void interpolate_window(const WindowBytes& gray, const WindowBytes& change,
                                        const Weights& weights, Window& window, WindowSums& sums) {
  Line upper = line_at(gray.row(0));
  for (int y = 0; y < kWindow; ++y) {
    WindowRow& row = window.rows[static_cast<std::size_t>(y)];
    const Line lower = line_at(gray.row(y + 1));
    const GrayRow levels = gray_between(upper, lower, weights);
    store(row.laned_gray, levels.laned);
    store(row.gray, levels.rest);
    upper = lower;
  }
  GradientLine first = gradient_line_at(change.row(0)), second = gradient_line_at(change.row(0) + 32);
  for (int y = 0; y < kWindow; ++y) {
    WindowRow& row = window.rows[static_cast<std::size_t>(y)];
    const GradientLine first_below = gradient_line_at(change.row(y + 1));
    take_laned(gradients_between(first, first_below, weights), row.laned_gradient[0], sums.laned);
    first = first_below;
    const GradientLine second_below = gradient_line_at(change.row(y + 1) + 32);
    take_laned(gradients_between(second, second_below, weights), row.laned_gradient[1], sums.laned);
    second = second_below;
  }
  GradientLine rest = gradient_line_at(change.row(0) + 64);
  for (int y = 0; y < kWindow; ++y) {
    const GradientLine rest_below = gradient_line_at(change.row(y + 1) + 64);
    take_rest(gradients_between(rest, rest_below, weights), window.rows[static_cast<std::size_t>(y)],
              sums.in_order);
    rest = rest_below;
  }
}

/// Gradients of eight pixels as they are.
STILLPOINT_AVX2 inline Gradients gradients_at(const unsigned char* from) {
  const __m256i both = load_bytes(from);
  return {_mm256_srai_epi32(_mm256_slli_epi32(both, 16), 16), _mm256_srai_epi32(both, 16)};
}

/// The same for a window that lies on whole pixels, as a corner's does in the full image.
STILLPOINT_AVX2 void copy_window(const WindowBytes& gray, const WindowBytes& change, Window& window,
                                 WindowSums& sums) {
  const __m256i low_half = _mm256_set1_epi32(0xFFFF);
  for (int y = 0; y < kWindow; ++y) {
    WindowRow& row = window.rows[static_cast<std::size_t>(y)];
    const Line line = line_at(gray.row(y));
    const __m256i laned = _mm256_blend_epi16(line.first, _mm256_slli_epi32(line.second, 16), 0xAA);
    store(row.laned_gray, _mm256_slli_epi16(laned, kGrayBits));
    store(row.gray, _mm256_slli_epi32(_mm256_and_si256(line.rest, low_half), kGrayBits));
    take_laned(gradients_at(change.row(y)), row.laned_gradient[0], sums.laned);
    take_laned(gradients_at(change.row(y) + 32), row.laned_gradient[1], sums.laned);
    take_rest(gradients_at(change.row(y) + 64), row, sums.in_order);
  }
}

/// Products of differences and gradients, of the pixels that are summed one after the other.
struct Products {
  alignas(32) std::array<std::array<std::int32_t, 8>, kWindow> x, y;
};

/// Their sums along x and y in order, each rounded to a float.
cv::Point2f sum_in_order(const Products& products) {
  cv::Point2f sum;
  for (std::size_t y = 0; y < kWindow; ++y)
    for (std::size_t k = 0; k < kRestPixels; ++k) {
      sum.x += static_cast<float>(products.x[y][k]);
      sum.y += static_cast<float>(products.y[y][k]);
    }
  return sum;
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
  WindowSums sums;
  if (place.is_on_pixels())
    copy_window(gray, change, window, sums);
  else
    interpolate_window(gray, change, weights_of(place), window, sums);
  window.a11 = (sums.in_order.xx + sum_of_lanes(sums.laned.xx)) * kSumScale;
  window.a12 = (sums.in_order.xy + sum_of_lanes(sums.laned.xy)) * kSumScale;
  window.a22 = (sums.in_order.yy + sum_of_lanes(sums.laned.yy)) * kSumScale;
}

STILLPOINT_AVX2 cv::Point2f mismatch(const Window& window, const cv::Mat& image, const WindowPlace& place) {
  const WindowBytes gray(image, place.corner, kGrayBytes);
  const Weights weights = weights_of(place);
  Products products;
  __m256 laned = _mm256_setzero_ps();  // four lanes along x, then four along y
  __m256i sum_x = _mm256_setzero_si256(), sum_y = sum_x, size_x = sum_x, size_y = sum_x;
  Line upper = line_at(gray.row(0));
  for (int y = 0; y < kWindow; ++y) {
    const WindowRow& row = window.rows[static_cast<std::size_t>(y)];
    const Line lower = line_at(gray.row(y + 1));
    const GrayRow levels = gray_between(upper, lower, weights);
    upper = lower;
    const __m256i off = _mm256_sub_epi16(levels.laned, load(row.laned_gray));
    const __m256i first = _mm256_permute4x64_epi64(off, 0x44), second = _mm256_permute4x64_epi64(off, 0xEE);
    laned = _mm256_add_ps(laned, _mm256_cvtepi32_ps(_mm256_madd_epi16(first, load(row.laned_gradient[0]))));
    laned = _mm256_add_ps(laned, _mm256_cvtepi32_ps(_mm256_madd_epi16(second, load(row.laned_gradient[1]))));
    const __m256i rest = _mm256_sub_epi32(levels.rest, load(row.gray));
    const __m256i x = _mm256_madd_epi16(rest, load(row.dx)), down = _mm256_madd_epi16(rest, load(row.dy));
    store(products.x[static_cast<std::size_t>(y)], x);
    store(products.y[static_cast<std::size_t>(y)], down);
    sum_x = _mm256_add_epi32(sum_x, x);
    sum_y = _mm256_add_epi32(sum_y, down);
    size_x = _mm256_add_epi32(size_x, _mm256_abs_epi32(x));
    size_y = _mm256_add_epi32(size_y, _mm256_abs_epi32(down));
  }
  // Sums that cannot reach kExact on the way are the same in any order.
  const __m256i four = _mm256_hadd_epi32(_mm256_hadd_epi32(sum_x, sum_y), _mm256_hadd_epi32(size_x, size_y));
  const __m128i sums = _mm_add_epi32(_mm256_castsi256_si128(four), _mm256_extracti128_si256(four, 1));
  const bool lanes_fit = _mm256_testz_si256(_mm256_or_si256(size_x, size_y), _mm256_set1_epi32(-kExact)) != 0;
  cv::Point2f sum;
  if (lanes_fit && _mm_extract_epi32(sums, 2) < kExact && _mm_extract_epi32(sums, 3) < kExact)
    sum = {static_cast<float>(_mm_extract_epi32(sums, 0)), static_cast<float>(_mm_extract_epi32(sums, 1))};
  else
    sum = sum_in_order(products);
  return {(sum.x + sum_of_lanes(_mm256_castps256_ps128(laned))) * kSumScale,
          (sum.y + sum_of_lanes(_mm256_extractf128_ps(laned, 1))) * kSumScale};
}

STILLPOINT_AVX2 float mean_difference(const Window& window, const cv::Mat& image, const WindowPlace& place) {
  const WindowBytes gray(image, place.corner, kGrayBytes);
  const Weights weights = weights_of(place);
  const __m256i in_window = _mm256_setr_epi32(-1, -1, -1, -1, -1, 0, 0, 0);
  __m256i sum = _mm256_setzero_si256();
  Line upper = line_at(gray.row(0));
  for (int y = 0; y < kWindow; ++y) {
    const WindowRow& row = window.rows[static_cast<std::size_t>(y)];
    const Line lower = line_at(gray.row(y + 1));
    const GrayRow levels = gray_between(upper, lower, weights);
    upper = lower;
    const __m256i off = _mm256_abs_epi16(_mm256_sub_epi16(levels.laned, load(row.laned_gray)));
    const __m256i rest = _mm256_abs_epi32(_mm256_sub_epi32(levels.rest, load(row.gray)));
    sum = _mm256_add_epi32(sum, _mm256_madd_epi16(off, _mm256_set1_epi16(1)));
    sum = _mm256_add_epi32(sum, _mm256_and_si256(rest, in_window));
  }
  alignas(32) std::array<std::int32_t, 8> lanes;
  store(lanes, sum);
  int whole = 0;  // at most 21² times 255 << 5: a float holds it
  for (const int lane : lanes) whole += lane;
  return static_cast<float>(whole) / static_cast<float>(32 * kWindow * kWindow);
}

}  // namespace stillpoint
#endif
