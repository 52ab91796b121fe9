#include "core/odometry/orb_descriptors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/features2d.hpp>

#include "core/avx2.hpp"

namespace stillpoint {
namespace {

cv::Mat described_by_opencv(const cv::Mat& level, std::vector<cv::KeyPoint> corners) {
  constexpr int kMost = 1000;  // of corners that were searched for; those given are all described
  const cv::Ptr<cv::ORB> orb =
      cv::ORB::create(kMost, 2.0F, 1, kOrbBorder, 0, 2, cv::ORB::FAST_SCORE, 2 * kOrbPatchRadius + 1);
  cv::Mat rows;
  const std::size_t given = corners.size();
  orb->compute(level, corners, rows);
  CV_Assert(corners.size() == given);
  return rows;
}

#if defined(__x86_64__)

constexpr std::size_t kTests = 256;  // bits of a descriptor, one a test (Rublee et al. 2011)

/// The two pixels each test of a descriptor compares, px from the corner: its bit is 1 where the first is
/// darker than the second.
struct OrbTests {
  using Places = std::array<float, kTests>;
  struct Pixels {
    Places x, y;
  };
  Pixels first, second;
};

/// Where a line may lie for a test to say 1, px from the corner.
struct Span {
  int begin = 1000, last = -1000;
  void take(int at) { begin = std::min(begin, at), last = std::max(last, at); }
};

constexpr int kBlurReach = 3;  // px from where it is that a line is seen

/// What tests say of a corner beside a line, the line being laid from one side to the other.
/// @param bright on black; otherwise dark on white. Either way the line is the stronger, the further right or
/// down, so that a test whose pixels lie side by side along the line tells them apart.
std::array<Span, kTests> lines_seen(bool upright, bool bright) {
  // px: what any test may see of a line, and room for a corner on either side of it
  constexpr int kFar = kOrbPatchRadius + kBlurReach, kMiddle = kFar + kOrbBorder, kSide = 2 * kMiddle + 1;
  constexpr int kWhite = 250, kFaintest = 20, kByPixel = 5;  // grey levels that survive blurring
  cv::Mat image(kSide, kSide, CV_8UC1, cv::Scalar(bright ? 0 : kWhite));
  for (int along = 0; along < kSide; ++along) {
    const int strength = kFaintest + kByPixel * std::clamp(along - kOrbBorder, 0, 2 * kFar);
    image.at<std::uint8_t>(upright ? along : kMiddle, upright ? kMiddle : along) =
        static_cast<std::uint8_t>(bright ? strength : kWhite - strength);
  }
  std::vector<cv::KeyPoint> corners;
  for (int off = -kFar; off <= kFar; ++off)
    corners.emplace_back(static_cast<float>(kMiddle - (upright ? off : 0)),
                         static_cast<float>(kMiddle - (upright ? 0 : off)), 1.0F, 0.0F);
  const cv::Mat rows = described_by_opencv(image, corners);
  std::array<Span, kTests> seen;
  for (int off = -kFar; off <= kFar; ++off)
    for (std::size_t t = 0; t < kTests; ++t)
      if (rows.ptr(off + kFar)[t / 8] >> t % 8 & 1) seen[t].take(off);
  return seen;
}

/// One coordinate of all tests' pixels.
void place_tests(bool upright, OrbTests::Places& first, OrbTests::Places& second) {
  // The brighter pixel is the one nearer to a bright line, and to a dark one the darker.
  const auto by_second = lines_seen(upright, true), by_first = lines_seen(upright, false);
  for (std::size_t t = 0; t < kTests; ++t) {
    const int begin = std::min(by_first[t].begin, by_second[t].begin),
              last = std::max(by_first[t].last, by_second[t].last);
    int low = begin + kBlurReach, high = last - kBlurReach;
    if (last - begin <= 2 * kBlurReach) low = high = (begin + last) / 2;  // both equally far
    const bool second_higher = by_second[t].last == last;
    first[t] = static_cast<float>(second_higher ? low : high);
    second[t] = static_cast<float>(second_higher ? high : low);
  }
}

/// OpenCV does not say which pixels its tests compare: its descriptors of lines do.
OrbTests found_tests() {
  OrbTests tests;
  place_tests(true, tests.first.x, tests.second.x);
  place_tests(false, tests.first.y, tests.second.y);
  return tests;
}

/// A corner's turn, as what it makes of a place's coordinates.
struct Turn {
  float cosine, sine;
};

/// Eight places of tests, turned and rounded to pixels: how far they lie from the corner in memory.
STILLPOINT_AVX2 inline void turn_eight(const OrbTests::Pixels& pixels, std::size_t first, const Turn& turn,
                                       int step, int* offsets) {
  const __m256 x = _mm256_loadu_ps(&pixels.x[first]), y = _mm256_loadu_ps(&pixels.y[first]);
  const __m256 cosine = _mm256_set1_ps(turn.cosine), sine = _mm256_set1_ps(turn.sine);
  const __m256i u = _mm256_cvtps_epi32(_mm256_sub_ps(_mm256_mul_ps(x, cosine), _mm256_mul_ps(y, sine)));
  const __m256i v = _mm256_cvtps_epi32(_mm256_add_ps(_mm256_mul_ps(x, sine), _mm256_mul_ps(y, cosine)));
  // Both fit 16 bits: u · 1 + v · step.
  const __m256i both = _mm256_blend_epi16(u, _mm256_slli_epi32(v, 16), 0xAA);
  _mm256_store_si256(reinterpret_cast<__m256i*>(offsets),
                     _mm256_madd_epi16(both, _mm256_set1_epi32(1 | step << 16)));
}

STILLPOINT_AVX2 Descriptor describe(const std::uint8_t* corner, int step, const Turn& turn,
                                    const OrbTests& tests) {
  constexpr std::size_t kWord = 64, kGroup = 8;  // tests: bits of a word of Descriptor, floats of a register
  alignas(32) std::array<int, kWord> first, second;
  Descriptor descriptor{};
  for (std::size_t word = 0; word < descriptor.size(); ++word) {
    for (std::size_t t = 0; t < kWord; t += kGroup) {
      turn_eight(tests.first, word * kWord + t, turn, step, &first[t]);
      turn_eight(tests.second, word * kWord + t, turn, step, &second[t]);
    }
    std::uint64_t bits = 0;
    for (std::size_t t = kWord; t-- > 0;) bits = bits + bits + (corner[first[t]] < corner[second[t]]);
    descriptor[word] = bits;
  }
  return descriptor;
}

#endif

}  // namespace

void describe_corners(const cv::Mat& level, const std::vector<cv::KeyPoint>& corners, BlurredLevel& blurred,
                      std::vector<Descriptor>& descriptors, bool wide) {
  descriptors.resize(corners.size());
  if (corners.empty()) return;
#if defined(__x86_64__)
  if (wide && can_blur_wide() && level.cols < (1 << 15)) {
    static const OrbTests tests = found_tests();
    blur_for_orb(level, blurred);
    const auto step = static_cast<int>(blurred.pixels.step);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const float angle = corners[i].angle * static_cast<float>(CV_PI / 180.0);
      descriptors[i] = describe(blurred.pixels.ptr(cvRound(corners[i].pt.y), cvRound(corners[i].pt.x)), step,
                                {std::cos(angle), std::sin(angle)}, tests);
    }
    return;
  }
#endif
  const cv::Mat rows = described_by_opencv(level, corners);
  for (std::size_t i = 0; i < corners.size(); ++i)
    std::memcpy(descriptors[i].data(), rows.ptr(static_cast<int>(i)), sizeof(Descriptor));
}

}  // namespace stillpoint
