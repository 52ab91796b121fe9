#include "core/odometry/smaller_level.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/avx2.hpp"

namespace stillpoint {

#if defined(__x86_64__)
namespace {

constexpr int kOne = 1 << 11;   // OpenCV's unit of weights
constexpr int kOutputs = 8;     // px made at once along a row …
constexpr int kInputs = 16;     // … out of so many bytes
constexpr int kDownwards = 16;  // px made at once out of two rows

/// Where a pixel of the smaller level lies between two of the larger one, as OpenCV reckons it.
struct Between {
  int first, second;             // px
  int weight, weight_of_second;  // 1/2048
};

Between between(int at, int size, int smaller) {
  const double scale = static_cast<double>(size) / smaller;
  const auto place = static_cast<float>((at + 0.5) * scale - 0.5);
  int first = cvFloor(place);
  float share = place - static_cast<float>(first);
  if (first < 0) first = 0, share = 0.0F;
  if (first >= size - 1) first = size - 1, share = 0.0F;
  return {first, std::min(first + 1, size - 1), cvRound((1.0F - share) * kOne), cvRound(share * kOne)};
}

/// Eight pixels of a row: which sixteen bytes of the larger one they lie in, which two each is made of, and
/// how much each of the two weighs.
struct EightOutputs {
  int from = 0;
  std::array<std::uint8_t, 4 * kOutputs> pairs{};  // pairs of bytes as 16 bits each, for _mm256_shuffle_epi8
  std::array<std::int16_t, 2 * kOutputs> weights{};
};

std::vector<EightOutputs> outputs_along(int width, int smaller) {
  constexpr std::uint8_t kNothing = 0x80;  // what makes a shuffled byte 0
  std::vector<EightOutputs> all(static_cast<std::size_t>((smaller + kOutputs - 1) / kOutputs));
  for (std::size_t e = 0; e < all.size(); ++e) {
    EightOutputs& eight = all[e];
    const int begin = static_cast<int>(e) * kOutputs;
    eight.from = std::min(between(begin, width, smaller).first, width - kInputs);
    for (int i = 0; i < kOutputs; ++i) {
      const Between b = between(std::min(begin + i, smaller - 1), width, smaller);
      const auto at = static_cast<std::size_t>(i);
      eight.pairs[4 * at] = static_cast<std::uint8_t>(b.first - eight.from);
      eight.pairs[4 * at + 2] = static_cast<std::uint8_t>(b.second - eight.from);
      eight.pairs[4 * at + 1] = eight.pairs[4 * at + 3] = kNothing;
      eight.weights[2 * at] = static_cast<std::int16_t>(b.weight);
      eight.weights[2 * at + 1] = static_cast<std::int16_t>(b.weight_of_second);
    }
  }
  return all;
}

STILLPOINT_AVX2 inline __m256i all_of(const void* from) {
  return _mm256_loadu_si256(static_cast<const __m256i*>(from));
}

/// A row made narrower, in 1/128 grey levels: as exact as OpenCV sums rows.
STILLPOINT_AVX2 void narrow(const std::uint8_t* row, const std::vector<EightOutputs>& outputs,
                            std::int16_t* narrower) {
  for (std::size_t e = 0; e < outputs.size(); ++e) {
    const EightOutputs& eight = outputs[e];
    const __m256i bytes =
        _mm256_broadcastsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(row + eight.from)));
    const __m256i sums =
        _mm256_srai_epi32(_mm256_madd_epi16(_mm256_shuffle_epi8(bytes, all_of(eight.pairs.data())),
                                            all_of(eight.weights.data())),
                          4);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(narrower + e * kOutputs),
                     _mm_packs_epi32(_mm256_castsi256_si128(sums), _mm256_extracti128_si256(sums, 1)));
  }
}

/// Two narrower rows, weighed.
STILLPOINT_AVX2 void join(const std::int16_t* first, const std::int16_t* second, const Between& weights,
                          int width, std::uint8_t* to) {
  const __m256i of_first = _mm256_set1_epi16(static_cast<short>(weights.weight)),
                of_second = _mm256_set1_epi16(static_cast<short>(weights.weight_of_second));
  for (int x = 0; x < width; x += kDownwards) {
    const __m256i sum = _mm256_add_epi16(_mm256_mulhi_epi16(all_of(first + x), of_first),
                                         _mm256_mulhi_epi16(all_of(second + x), of_second));
    const __m256i gray = _mm256_srai_epi16(_mm256_add_epi16(sum, _mm256_set1_epi16(2)), 2);
    const __m128i bytes = _mm_packus_epi16(_mm256_castsi256_si128(gray), _mm256_extracti128_si256(gray, 1));
    if (x + kDownwards <= width) {
      _mm_storeu_si128(reinterpret_cast<__m128i*>(to + x), bytes);
    } else {
      std::array<std::uint8_t, kDownwards> rest;
      _mm_storeu_si128(reinterpret_cast<__m128i*>(rest.data()), bytes);
      std::memcpy(to + x, rest.data(), static_cast<std::size_t>(width - x));
    }
  }
}

/// A narrower row and which row of the larger level it is of.
struct NarrowRow {
  int of = -1;
  std::vector<std::int16_t> sums;
};

void shrink(const cv::Mat& level, cv::Mat& smaller) {
  const std::vector<EightOutputs> outputs = outputs_along(level.cols, smaller.cols);
  const std::size_t room = outputs.size() * kOutputs + kDownwards;
  std::array<NarrowRow, 2> rows{NarrowRow{-1, std::vector<std::int16_t>(room)},
                                NarrowRow{-1, std::vector<std::int16_t>(room)}};
  const auto row_of = [&](int y) {
    NarrowRow& row = rows[static_cast<std::size_t>(y % 2)];  // two that follow each other, or one twice
    if (row.of != y) narrow(level.ptr(y), outputs, row.sums.data());
    row.of = y;
    return row.sums.data();
  };
  for (int y = 0; y < smaller.rows; ++y) {
    const Between at = between(y, level.rows, smaller.rows);
    join(row_of(at.first), row_of(at.second), at, smaller.cols, smaller.ptr(y));
  }
}

}  // namespace
#endif

void make_smaller_level(const cv::Mat& level, const cv::Size& size, cv::Mat& smaller, bool wide) {
#if defined(__x86_64__)
  const bool close = 2 * size.width > level.cols && 2 * size.height > level.rows &&
                     size.width <= level.cols && size.height <= level.rows;
  if (wide && close && level.cols >= kInputs) {
    smaller.create(size, CV_8UC1);
    shrink(level, smaller);
    return;
  }
#endif
  cv::resize(level, smaller, size, 0, 0, cv::INTER_LINEAR);
}

}  // namespace stillpoint
