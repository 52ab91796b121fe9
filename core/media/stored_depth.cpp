#include "core/media/stored_depth.hpp"

#include <fmt/format.h>

#include <opencv2/core/fast_math.hpp>

#include "core/avx2.hpp"

namespace stillpoint {
namespace {

constexpr int kNothing = 65535;  // the largest value is what sensors write where they measured nothing

void row_in_metres(const std::uint16_t* from, int first, int width, float unit, float* to) {
  for (int x = first; x < width; ++x)
    to[x] = static_cast<float>(from[x] == kNothing ? 0 : static_cast<int>(from[x])) * unit;
}

#if defined(__x86_64__)
/// row_in_metres() of eight pixels at a time.
STILLPOINT_AVX2 void row_in_metres_by_avx2(const std::uint16_t* from, int width, float unit, float* to) {
  constexpr int kAtOnce = 8;  // px: floats of a register
  const __m256i nothing = _mm256_set1_epi32(kNothing);
  int x = 0;
  for (; x + kAtOnce <= width; x += kAtOnce) {
    const __m256i stored = _mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from + x)));
    const __m256i measured = _mm256_andnot_si256(_mm256_cmpeq_epi32(stored, nothing), stored);
    _mm256_storeu_ps(to + x, _mm256_mul_ps(_mm256_cvtepi32_ps(measured), _mm256_set1_ps(unit)));
  }
  row_in_metres(from, x, width, unit, to);
}
#else
void row_in_metres_by_avx2(const std::uint16_t*, int, float, float*) {}
#endif

}  // namespace

StoredDepth stored_depth(const cv::Mat& metres, double units, std::uint16_t none) {
  StoredDepth stored;
  stored.image.create(metres.size(), CV_16UC1);
  for (int y = 0; y < metres.rows; ++y) {
    const auto* from = metres.ptr<float>(y);
    auto* to = stored.image.ptr<std::uint16_t>(y);
    for (int x = 0; x < metres.cols; ++x) {
      const double value = static_cast<double>(from[x]) * units;
      const bool too_far = value > kMostStored + 0.5;
      const int rounded = value > 0 && !too_far ? cvRound(value) : 0;
      to[x] = rounded > 0 ? static_cast<std::uint16_t>(rounded) : none;
      stored.too_far += too_far ? 1 : 0;
    }
  }
  return stored;
}

cv::Mat metres_of(const cv::Mat& stored, double units, bool wide) {
  CV_Assert(stored.type() == CV_16UC1);
  cv::Mat metres(stored.size(), CV_32FC1);
  const auto unit = static_cast<float>(1.0 / units);
  for (int y = 0; y < stored.rows; ++y) {
    const auto* from = stored.ptr<std::uint16_t>(y);
    auto* to = metres.ptr<float>(y);
    wide ? row_in_metres_by_avx2(from, stored.cols, unit, to) : row_in_metres(from, 0, stored.cols, unit, to);
  }
  return metres;
}

std::string too_far_told(std::int64_t pixels, double units) {
  if (pixels == 0) return "";
  return fmt::format(
      "{} pixels of depth are farther than the {:.1f} m that 16 bits hold, and are written as not measured",
      pixels, kMostStored / units);
}

}  // namespace stillpoint
