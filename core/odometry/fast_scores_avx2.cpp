// Compiled for AVX2 where there is such a thing, and asked only there: nothing of the standard library may be
// called here that another file could be given in its place.
#include "core/odometry/fast_scores.hpp"

#ifdef __AVX2__
#include <immintrin.h>

namespace stillpoint {
namespace {

struct Bytes32 {
  static constexpr int kLanes = 32;  // bytes of a register of 256 bits
  __m256i bytes;

  static Bytes32 all(unsigned char value) { return {_mm256_set1_epi8(static_cast<char>(value))}; }
  static Bytes32 load(const unsigned char* from) {
    return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(from))};
  }
  void store(unsigned char* to) const { _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), bytes); }
  [[nodiscard]] bool any() const { return _mm256_testz_si256(bytes, bytes) == 0; }
  [[nodiscard]] Bytes32 where_at_least(const Bytes32& least) const {
    return {_mm256_and_si256(bytes, _mm256_cmpeq_epi8(_mm256_max_epu8(bytes, least.bytes), bytes))};
  }
  friend Bytes32 min(const Bytes32& a, const Bytes32& b) { return {_mm256_min_epu8(a.bytes, b.bytes)}; }
  friend Bytes32 max(const Bytes32& a, const Bytes32& b) { return {_mm256_max_epu8(a.bytes, b.bytes)}; }
  friend Bytes32 operator+(const Bytes32& a, const Bytes32& b) {
    return {_mm256_adds_epu8(a.bytes, b.bytes)};
  }
  friend Bytes32 operator-(const Bytes32& a, const Bytes32& b) {
    return {_mm256_subs_epu8(a.bytes, b.bytes)};
  }
};

}  // namespace

int fast_scores_by_avx2(const FastCircle& circle, int threshold, const unsigned char* row, int width,
                        int readable, unsigned char* scores) {
  return FastScores<Bytes32>(circle, threshold).of_row(row, width, readable, scores);
}

void fast_peaks_by_avx2(const unsigned char* above, const unsigned char* row, const unsigned char* below,
                        int width, unsigned* peaks) {
  for (int x = 0; x < width; x += Bytes32::kLanes) {
    Bytes32 about = max(Bytes32::load(row + x - 1), Bytes32::load(row + x + 1));
    for (const unsigned char* beside : {above, below})
      for (int shift = -1; shift <= 1; ++shift) about = max(about, Bytes32::load(beside + x + shift));
    const Bytes32 score = Bytes32::load(row + x);
    // At most what is about it: no peak.
    const __m256i lower = _mm256_cmpeq_epi8(max(score, about).bytes, about.bytes);
    peaks[x / Bytes32::kLanes] = ~static_cast<unsigned>(_mm256_movemask_epi8(lower));
  }
}

}  // namespace stillpoint
#else

namespace stillpoint {

int fast_scores_by_avx2(const FastCircle&, int, const unsigned char*, int, int, unsigned char*) { return 0; }

void fast_peaks_by_avx2(const unsigned char*, const unsigned char*, const unsigned char*, int, unsigned*) {}

}  // namespace stillpoint
#endif
