#include "core/odometry/orb_blur.hpp"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/avx2.hpp"

namespace stillpoint {

#if defined(__x86_64__)
namespace {

constexpr int kBlurRadius = 3, kTaps = 2 * kBlurRadius + 1;  // px
constexpr int kFloats = 8, kBytes = 32;                      // px at once
using BlurWeights = std::array<float, kTaps>;

BlurWeights orb_weights() {
  constexpr double kSigma = 2.0;  // px
  const cv::Mat kernel = cv::getGaussianKernel(kTaps, kSigma, CV_32F);
  BlurWeights weights{};
  std::copy_n(kernel.ptr<float>(), weights.size(), weights.begin());
  return weights;
}

/// A row as floats, mirrored at both ends.
STILLPOINT_AVX2_FMA void widen(const std::uint8_t* row, int width, float* floats) {
  int x = 0;
  for (; x + kFloats <= width; x += kFloats)
    _mm256_storeu_ps(
        floats + x,
        _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(row + x)))));
  for (; x < width; ++x) floats[x] = row[x];
  for (int k = 1; k <= kBlurRadius; ++k) {
    floats[-k] = floats[k];
    floats[width - 1 + k] = floats[width - 1 - k];
  }
}

/// Sums along a row, in OpenCV's order: from the left on.
STILLPOINT_AVX2_FMA void sum_along(const float* floats, int width, const BlurWeights& weights, float* sums) {
  for (int x = 0; x < width; x += kFloats) {
    const float* leftmost = floats + x - kBlurRadius;
    __m256 sum = _mm256_mul_ps(_mm256_set1_ps(weights[0]), _mm256_loadu_ps(leftmost));
    for (std::size_t k = 1; k < weights.size(); ++k)
      sum = _mm256_fmadd_ps(_mm256_set1_ps(weights[k]), _mm256_loadu_ps(leftmost + k), sum);
    _mm256_storeu_ps(sums + x, sum);
  }
}

using RowsOfSums = std::array<const float*, kTaps>;

/// Eight pixels of the sums of seven rows, in OpenCV's order: from the middle on, two rows at a time.
STILLPOINT_AVX2_FMA inline __m256i sum_down(const RowsOfSums& rows, int x, const BlurWeights& weights) {
  __m256 sum = _mm256_mul_ps(_mm256_set1_ps(weights[kBlurRadius]), _mm256_loadu_ps(rows[kBlurRadius] + x));
  for (std::size_t k = 1; k <= kBlurRadius; ++k)
    sum = _mm256_fmadd_ps(
        _mm256_set1_ps(weights[kBlurRadius + k]),
        _mm256_add_ps(_mm256_loadu_ps(rows[kBlurRadius + k] + x), _mm256_loadu_ps(rows[kBlurRadius - k] + x)),
        sum);
  return _mm256_cvtps_epi32(sum);
}

STILLPOINT_AVX2_FMA void sum_rows_down(const RowsOfSums& rows, int width, const BlurWeights& weights,
                                       std::uint8_t* to) {
  const __m256i in_order = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
  for (int x = 0; x < width; x += kBytes) {
    const __m256i left = _mm256_packs_epi32(sum_down(rows, x, weights), sum_down(rows, x + kFloats, weights));
    const __m256i right = _mm256_packs_epi32(sum_down(rows, x + 2 * kFloats, weights),
                                             sum_down(rows, x + 3 * kFloats, weights));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + x),
                        _mm256_permutevar8x32_epi32(_mm256_packus_epi16(left, right), in_order));
  }
}

}  // namespace

bool can_blur_wide() {
  static const bool can = cv::checkHardwareSupport(CV_CPU_AVX2) && cv::checkHardwareSupport(CV_CPU_FMA3);
  return can;
}

void blur_for_orb(const cv::Mat& level, BlurredLevel& blurred) {
  static const BlurWeights weights = orb_weights();
  const int width = level.cols, height = level.rows, padded = (width + kBytes - 1) / kBytes * kBytes;
  CV_Assert(level.type() == CV_8UC1 && width > kBlurRadius && height > kBlurRadius);
  blurred.pixels.create(height, padded, CV_8UC1);
  // A row of floats with room to both sides, and the sums of the seven rows last summed.
  std::vector<float> memory(static_cast<std::size_t>(padded * (kTaps + 1) + 2 * kFloats), 0.0F);
  float *floats = memory.data() + kFloats, *sums = floats + padded + kFloats;
  const auto sums_of = [&](int y) { return sums + y % kTaps * padded; };
  int summed = 0;  // rows
  for (int y = 0; y < height; ++y) {
    for (; summed < std::min(height, y + kBlurRadius + 1); ++summed) {
      widen(level.ptr(summed), width, floats);
      sum_along(floats, padded, weights, sums_of(summed));
    }
    RowsOfSums rows{};
    for (int k = 0; k < kTaps; ++k)
      rows[static_cast<std::size_t>(k)] =
          sums_of(cv::borderInterpolate(y + k - kBlurRadius, height, cv::BORDER_REFLECT_101));
    sum_rows_down(rows, padded, weights, blurred.pixels.ptr(y));
  }
}

#else

bool can_blur_wide() { return false; }

void blur_for_orb(const cv::Mat&, BlurredLevel&) { CV_Assert(!"this processor has no wide lanes"); }

#endif

}  // namespace stillpoint
