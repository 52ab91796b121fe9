#include "core/odometry/fast_corners.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <opencv2/core/hal/intrin.hpp>

#include "core/odometry/fast_scores.hpp"

namespace stillpoint {
namespace {

/// Sixteen bytes side by side.
struct Bytes16 {
  static constexpr int kLanes = cv::v_uint8x16::nlanes;
  cv::v_uint8x16 bytes;

  static Bytes16 all(uchar value) { return {cv::v_setall_u8(value)}; }
  static Bytes16 load(const uchar* from) { return {cv::v_load(from)}; }
  void store(uchar* to) const { cv::v_store(to, bytes); }
  [[nodiscard]] bool any() const { return cv::v_check_any(bytes > cv::v_setzero_u8()); }
  [[nodiscard]] Bytes16 where_at_least(const Bytes16& least) const {
    return {bytes & (bytes >= least.bytes)};
  }
  friend Bytes16 min(const Bytes16& a, const Bytes16& b) { return {cv::v_min(a.bytes, b.bytes)}; }
  friend Bytes16 max(const Bytes16& a, const Bytes16& b) { return {cv::v_max(a.bytes, b.bytes)}; }
  friend Bytes16 operator+(const Bytes16& a, const Bytes16& b) { return {a.bytes + b.bytes}; }
  friend Bytes16 operator-(const Bytes16& a, const Bytes16& b) { return {a.bytes - b.bytes}; }
};

constexpr int kLanes = Bytes16::kLanes, kMostLanes = 32;  // bytes at once: of this unit, and of the widest

FastCircle circle_of(const cv::Mat& image) {
  // Bresenham's circle of radius 3 px, as OpenCV goes round it.
  constexpr std::array<std::array<int, 2>, kFastCircle> kAbout{{{0, 3},
                                                                {1, 3},
                                                                {2, 2},
                                                                {3, 1},
                                                                {3, 0},
                                                                {3, -1},
                                                                {2, -2},
                                                                {1, -3},
                                                                {0, -3},
                                                                {-1, -3},
                                                                {-2, -2},
                                                                {-3, -1},
                                                                {-3, 0},
                                                                {-3, 1},
                                                                {-2, 2},
                                                                {-1, 3}}};
  FastCircle circle{};
  for (std::size_t k = 0; k < kFastCircle; ++k)
    circle[k] = kAbout[k][0] + kAbout[k][1] * static_cast<std::ptrdiff_t>(image.step);
  return circle;
}

/// The highest threshold at which a pixel is a corner; 0 below `threshold`.
uchar score_of(const uchar* centre, const FastCircle& circle, int threshold) {
  int best = 0;
  for (std::size_t first = 0; first < kFastCircle; ++first) {
    int brighter = 255, darker = 255;
    for (std::size_t k = first; k < first + kFastArc; ++k) {
      const int off = centre[circle[k % kFastCircle]] - *centre;
      brighter = std::min(brighter, off), darker = std::min(darker, -off);
    }
    best = std::max({best, brighter, darker});
  }
  return best > threshold ? static_cast<uchar>(best - 1) : uchar{0};
}

/// A row's scores, with a zero before its first and zeros behind its last, as far as lanes reach.
void score_row(const uchar* row, int width, int readable, const FastCircle& circle, int threshold, bool wide,
               uchar* scores) {
  int x = wide ? fast_scores_by_avx2(circle, threshold, row, width, readable, scores + 1) : 0;
  x += FastScores<Bytes16>(circle, threshold).of_row(row + x, width - x, readable - x, scores + 1 + x);
  for (; x < width; ++x) scores[1 + x] = score_of(row + x, circle, threshold);
  std::fill_n(scores + 1 + width, kMostLanes + 1, uchar{0});
}

using ThreeRows = std::array<uchar*, 3>;

/// Which of the middle one of three rows of scores are above all eight neighbours, a bit each.
void find_peaks(const ThreeRows& rows, int width, unsigned* peaks) {
  const auto score_at = [&](int x) { return Bytes16::load(rows[1] + 1 + x); };
  std::fill_n(peaks, (width + kMostLanes - 1) / kMostLanes, 0U);
  for (int x = 0; x < width; x += kLanes) {
    // Mostly there are none: looked for in twice as many at a time.
    if (x % (2 * kLanes) == 0 && !max(score_at(x), score_at(x + kLanes)).any()) {
      x += kLanes;
      continue;
    }
    const cv::v_uint8x16 score = score_at(x).bytes;
    if (!Bytes16{score}.any()) continue;
    cv::v_uint8x16 about = cv::v_max(cv::v_load(rows[1] + x), cv::v_load(rows[1] + x + 2));
    for (const uchar* beside : {rows[0], rows[2]})
      for (int shift = 0; shift <= 2; ++shift) about = cv::v_max(about, cv::v_load(beside + x + shift));
    peaks[x / kMostLanes] |= static_cast<unsigned>(cv::v_signmask(score > about)) << x % kMostLanes;
  }
}

/// Corners of the middle one of three rows of scores.
void append_peaks(const ThreeRows& rows, int width, const cv::Point& first, bool wide, unsigned* peaks,
                  std::vector<cv::KeyPoint>& corners) {
  if (wide)
    fast_peaks_by_avx2(rows[0] + 1, rows[1] + 1, rows[2] + 1, width, peaks);
  else
    find_peaks(rows, width, peaks);
  for (int x = 0; x < width; x += kMostLanes)
    for (unsigned those = peaks[x / kMostLanes]; those != 0; those &= those - 1) {
      const int at = x + std::countr_zero(those);
      corners.emplace_back(static_cast<float>(first.x + at), static_cast<float>(first.y), 7.0F, -1.0F,
                           static_cast<float>(rows[1][1 + at]));
    }
}

}  // namespace

void append_fast_corners(const cv::Mat& image, const cv::Rect& where, int threshold,
                         std::vector<cv::KeyPoint>& corners, bool wide) {
  if (where.empty()) return;
  CV_Assert(image.type() == CV_8UC1 && where.x >= kFastRadius && where.y >= kFastRadius &&
            where.br().x + kFastRadius <= image.cols && where.br().y + kFastRadius <= image.rows);
  const FastCircle circle = circle_of(image);
  const int level = std::clamp(threshold, 1, 255);
  const auto stride = static_cast<std::size_t>(where.width + 2 * kMostLanes + 2);
  cv::AutoBuffer<uchar, 4096> memory(3 * stride);
  std::fill_n(memory.data(), memory.size(), uchar{0});
  cv::AutoBuffer<unsigned, 64> peaks(static_cast<std::size_t>((where.width + kMostLanes - 1) / kMostLanes));
  ThreeRows rows{memory.data(), memory.data() + stride, memory.data() + 2 * stride};
  for (int y = 0; y <= where.height; ++y) {
    std::rotate(rows.begin(), rows.begin() + 1,
                rows.end());  // the last is that of y, the middle one of y - 1
    if (y < where.height)
      score_row(image.ptr<uchar>(where.y + y) + where.x, where.width, image.cols - where.x, circle, level,
                wide, rows[2]);
    else
      std::fill_n(rows[2], stride, uchar{0});
    if (y > 0) append_peaks(rows, where.width, {where.x, where.y + y - 1}, wide, peaks.data(), corners);
  }
}

}  // namespace stillpoint
