#pragma once

#include <array>
#include <cstddef>

namespace stillpoint {

constexpr std::size_t kFastCircle = 16, kFastArc = 9;  // pixels about a corner, and how many must differ
constexpr int kFastRadius = 3;                         // px: FAST-9-16's circle

/// Where the circle's pixels lie from its centre, in bytes.
using FastCircle = std::array<std::ptrdiff_t, kFastCircle>;

/// The score of FAST (the highest threshold at which a pixel is a corner; 0 below `threshold`) of a row's
/// pixels, as many at once as `Bytes` holds, for as long as they lie within the `readable` bytes.
/// @tparam Bytes unsigned bytes side by side, whose sums and differences stop at 255 and 0
/// @returns the first pixel that is left, `width` or more where none is
template <typename Bytes>
class FastScores {
 public:
  FastScores(const FastCircle& circle, int threshold)
      : circle_(circle), threshold_(Bytes::all(static_cast<unsigned char>(threshold))) {}

  int of_row(const unsigned char* row, int width, int readable, unsigned char* scores) const {
    int x = 0;
    for (; x < width && x + Bytes::kLanes + kFastRadius <= readable; x += Bytes::kLanes)
      of_block(row + x).store(scores + x);
    return x;
  }

 private:
  Bytes at(const unsigned char* centre, std::size_t k) const { return Bytes::load(centre + circle_[k]); }

  /// By how much nine neighbours on the circle differ at least, of those nine that differ most; `off` is how
  /// far each pixel lies on one side of the centre, 0 on the other.
  static Bytes best_arc(const std::array<Bytes, kFastCircle>& off) {
    // Two arcs that begin beside each other share eight pixels.
    std::array<Bytes, kFastCircle / 2> two, four;
    for (std::size_t k = 0; k < two.size(); ++k) two[k] = min(off[2 * k + 1], off[(2 * k + 2) % kFastCircle]);
    for (std::size_t k = 0; k < four.size(); ++k) four[k] = min(two[k], two[(k + 1) % two.size()]);
    Bytes best = Bytes::all(0);
    for (std::size_t k = 0; k < four.size(); ++k) {
      const Bytes eight = min(four[k], four[(k + 2) % four.size()]);
      best = max(best, min(eight, max(off[2 * k], off[(2 * k + kFastArc) % kFastCircle])));
    }
    return best;
  }

  Bytes of_block(const unsigned char* centre) const {
    const Bytes v = Bytes::load(centre), above = v + threshold_, below = v - threshold_;
    // Of two pixels opposite each other nine in a row hold one at least.
    Bytes brightest = Bytes::all(255), darkest = Bytes::all(0);
    for (std::size_t k = 0; k < kFastCircle / 2; k += 2) {
      const Bytes a = at(centre, k), b = at(centre, k + kFastCircle / 2);
      brightest = min(brightest, max(a, b));
      darkest = max(darkest, min(a, b));
    }
    Bytes best = Bytes::all(0);
    std::array<Bytes, kFastCircle> off;
    if ((brightest - above).any()) {
      for (std::size_t k = 0; k < kFastCircle; ++k) off[k] = at(centre, k) - v;
      best = best_arc(off);
    }
    if ((below - darkest).any()) {
      for (std::size_t k = 0; k < kFastCircle; ++k) off[k] = v - at(centre, k);
      best = max(best, best_arc(off));
    }
    return (best - Bytes::all(1)).where_at_least(threshold_);
  }

  FastCircle circle_;
  Bytes threshold_;
};

/// FastScores of 32 pixels at once; only on processors that have AVX2.
/// @returns the first pixel that is left, as FastScores does
int fast_scores_by_avx2(const FastCircle& circle, int threshold, const unsigned char* row, int width,
                        int readable, unsigned char* scores);

/// Which of a row's scores are above those of all eight neighbours, a bit each, 32 pixels at a time; only on
/// processors that have AVX2.
/// @param above, row, below scores, each with one before its first and 34 behind its last
/// @param peaks as many as it takes for `width` bits
void fast_peaks_by_avx2(const unsigned char* above, const unsigned char* row, const unsigned char* below,
                        int width, unsigned* peaks);

}  // namespace stillpoint
