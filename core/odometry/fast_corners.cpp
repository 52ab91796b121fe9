#include "core/odometry/fast_corners.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <opencv2/core/hal/intrin.hpp>

namespace stillpoint {
namespace {

constexpr int kRadius = 3;  // px
constexpr std::size_t kCircle = 16, kArc = 9;
constexpr int kLanes = cv::v_uint8x16::nlanes;

/// Where the circle's pixels lie from its centre, in bytes.
using Circle = std::array<std::ptrdiff_t, kCircle>;

Circle circle_of(const cv::Mat& image) {
  constexpr std::array<std::array<int, 2>, kCircle> kAbout{{{0, 3},
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
  Circle circle{};
  for (std::size_t k = 0; k < kCircle; ++k)
    circle[k] = kAbout[k][0] + kAbout[k][1] * static_cast<std::ptrdiff_t>(image.step);
  return circle;
}

/// By how much nine neighbours on the circle differ at least, of those nine that differ most; `off` is how
/// far each pixel lies on one side of the centre, 0 on the other.
cv::v_uint8x16 best_arc(const std::array<cv::v_uint8x16, kCircle>& off) {
  // Two arcs that begin beside each other share eight pixels.
  std::array<cv::v_uint8x16, kCircle / 2> two, four;
  for (std::size_t k = 0; k < two.size(); ++k) two[k] = cv::v_min(off[2 * k + 1], off[(2 * k + 2) % kCircle]);
  for (std::size_t k = 0; k < four.size(); ++k) four[k] = cv::v_min(two[k], two[(k + 1) % two.size()]);
  cv::v_uint8x16 best = cv::v_setzero_u8();
  for (std::size_t k = 0; k < four.size(); ++k) {
    const cv::v_uint8x16 eight = cv::v_min(four[k], four[(k + 2) % four.size()]);
    best = cv::v_max(best, cv::v_min(eight, cv::v_max(off[2 * k], off[(2 * k + kArc) % kCircle])));
  }
  return best;
}

bool any(const cv::v_uint8x16& values) { return cv::v_check_any(values > cv::v_setzero_u8()); }

/// The highest threshold at which each of sixteen pixels is a corner; 0 below `threshold`.
cv::v_uint8x16 scores_of(const uchar* centre, const Circle& circle, const cv::v_uint8x16& threshold) {
  const cv::v_uint8x16 v = cv::v_load(centre), above = v + threshold, below = v - threshold;
  const auto at = [&](std::size_t k) { return cv::v_load(centre + circle[k]); };
  // Of two pixels opposite each other nine in a row hold one at least. Sums and differences stop at 255 and
  // 0.
  cv::v_uint8x16 brightest = cv::v_setall_u8(255), darkest = cv::v_setzero_u8();
  for (std::size_t k = 0; k < kCircle / 2; k += 2) {
    const cv::v_uint8x16 a = at(k), b = at(k + kCircle / 2);
    brightest = cv::v_min(brightest, cv::v_max(a, b));
    darkest = cv::v_max(darkest, cv::v_min(a, b));
  }
  const bool bright = any(brightest - above), dark = any(below - darkest);
  cv::v_uint8x16 best = cv::v_setzero_u8();
  std::array<cv::v_uint8x16, kCircle> off;
  if (bright) {
    for (std::size_t k = 0; k < kCircle; ++k) off[k] = at(k) - v;
    best = best_arc(off);
  }
  if (dark) {
    for (std::size_t k = 0; k < kCircle; ++k) off[k] = v - at(k);
    best = cv::v_max(best, best_arc(off));
  }
  const cv::v_uint8x16 score = best - cv::v_setall_u8(1);
  return score & (score >= threshold);
}

/// The same of one pixel.
uchar score_of(const uchar* centre, const Circle& circle, int threshold) {
  int best = 0;
  for (std::size_t first = 0; first < kCircle; ++first) {
    int brighter = 255, darker = 255;
    for (std::size_t k = first; k < first + kArc; ++k) {
      const int off = centre[circle[k % kCircle]] - *centre;
      brighter = std::min(brighter, off), darker = std::min(darker, -off);
    }
    best = std::max({best, brighter, darker});
  }
  return best > threshold ? static_cast<uchar>(best - 1) : uchar{0};
}

/// A row's scores, with a zero before its first and zeros behind its last, as far as lanes reach.
void score_row(const uchar* row, int width, int readable, const Circle& circle, int threshold,
               uchar* scores) {
  const cv::v_uint8x16 thresholds = cv::v_setall_u8(static_cast<uchar>(threshold));
  int x = 0;
  for (; x < width && x + kLanes + kRadius <= readable; x += kLanes)
    cv::v_store(scores + 1 + x, scores_of(row + x, circle, thresholds));
  for (; x < width; ++x) scores[1 + x] = score_of(row + x, circle, threshold);
  std::fill_n(scores + 1 + width, kLanes + 1, uchar{0});
}

/// Corners of the middle one of three rows of scores: those above all eight neighbours.
void append_peaks(const std::array<uchar*, 3>& rows, int width, const cv::Point& first,
                  std::vector<cv::KeyPoint>& corners) {
  for (int x = 0; x < width; x += kLanes) {
    const cv::v_uint8x16 score = cv::v_load(rows[1] + 1 + x);
    if (!any(score)) continue;
    cv::v_uint8x16 about = cv::v_max(cv::v_load(rows[1] + x), cv::v_load(rows[1] + x + 2));
    for (const uchar* beside : {rows[0], rows[2]})
      for (int shift = 0; shift <= 2; ++shift) about = cv::v_max(about, cv::v_load(beside + x + shift));
    for (int peaks = cv::v_signmask(score > about); peaks != 0; peaks &= peaks - 1) {
      const int at = x + std::countr_zero(static_cast<unsigned>(peaks));
      corners.emplace_back(static_cast<float>(first.x + at), static_cast<float>(first.y), 7.0F, -1.0F,
                           static_cast<float>(rows[1][1 + at]));
    }
  }
}

}  // namespace

void append_fast_corners(const cv::Mat& image, const cv::Rect& where, int threshold,
                         std::vector<cv::KeyPoint>& corners) {
  if (where.empty()) return;
  CV_Assert(image.type() == CV_8UC1 && where.x >= kRadius && where.y >= kRadius &&
            where.br().x + kRadius <= image.cols && where.br().y + kRadius <= image.rows);
  const Circle circle = circle_of(image);
  const int level = std::clamp(threshold, 1, 255);
  const auto stride = static_cast<std::size_t>(where.width + 2 * kLanes + 2);
  cv::AutoBuffer<uchar, 4096> memory(3 * stride);
  std::fill_n(memory.data(), memory.size(), uchar{0});
  std::array<uchar*, 3> rows{memory.data(), memory.data() + stride, memory.data() + 2 * stride};
  for (int y = 0; y <= where.height; ++y) {
    std::rotate(rows.begin(), rows.begin() + 1,
                rows.end());  // the last is that of y, the middle one of y - 1
    if (y < where.height)
      score_row(image.ptr<uchar>(where.y + y) + where.x, where.width, image.cols - where.x, circle, level,
                rows[2]);
    else
      std::fill_n(rows[2], stride, uchar{0});
    if (y > 0) append_peaks(rows, where.width, {where.x, where.y + y - 1}, corners);
  }
}

}  // namespace stillpoint
