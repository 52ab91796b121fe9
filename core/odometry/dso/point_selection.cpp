#include "core/odometry/dso/point_selection.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillpoint {
namespace {

constexpr int kBlock = 32;         // px: blocks of one threshold, as DSO has them
constexpr float kCoarser = 0.75F;  // of the threshold a level, as DSO has it: averages are less steep

float steepness(const cv::Mat& level, int x, int y) {
  const cv::Vec3f& pixel = level.at<cv::Vec3f>(y, x);
  return std::hypot(pixel[1], pixel[2]);
}

/// The steepest usable pixel of a square of the full image, by one level's gradient; -1 where none passes.
DsoCandidate steepest(const DsoImage& image, const cv::Mat& thresholds, const cv::Mat& usable, int left,
                      int top, int side, int level, float factor) {
  const cv::Mat &full = image.levels.front(), &at = image.levels[static_cast<std::size_t>(level)];
  DsoCandidate best{-1, -1, level};
  float most = 0.0F;
  const int right = std::min(left + side, full.cols - kDsoReach - 1),
            bottom = std::min(top + side, full.rows - kDsoReach - 1);
  for (int y = std::max(top, kDsoReach); y < bottom; ++y)
    for (int x = std::max(left, kDsoReach); x < right; ++x) {
      if (!usable.empty() && usable.at<std::uint8_t>(y, x) == 0) continue;
      const float steep = steepness(at, std::min(x >> level, at.cols - 1), std::min(y >> level, at.rows - 1));
      const float least = factor * thresholds.at<float>(std::min(y / kBlock, thresholds.rows - 1),
                                                        std::min(x / kBlock, thresholds.cols - 1));
      if (steep > least && steep > most) most = steep, best.x = x, best.y = y;
    }
  return best;
}

}  // namespace

cv::Mat gradient_thresholds(const DsoImage& image, double margin) {
  const cv::Mat& level = image.levels.front();
  const int columns = std::max(1, level.cols / kBlock), rows = std::max(1, level.rows / kBlock);
  cv::Mat medians(rows, columns, CV_32FC1);
  std::vector<float> values;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      values.clear();
      for (int y = r * kBlock; y < std::min((r + 1) * kBlock, level.rows); ++y)
        for (int x = c * kBlock; x < std::min((c + 1) * kBlock, level.cols); ++x)
          values.push_back(steepness(level, x, y));
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
      std::nth_element(values.begin(), middle, values.end());
      medians.at<float>(r, c) = *middle + static_cast<float>(margin);
    }
  cv::Mat smoothed(medians.size(), CV_32FC1);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      float sum = 0.0F;
      int count = 0;
      for (int y = std::max(0, r - 1); y <= std::min(rows - 1, r + 1); ++y)
        for (int x = std::max(0, c - 1); x <= std::min(columns - 1, c + 1); ++x)
          sum += medians.at<float>(y, x), ++count;
      smoothed.at<float>(r, c) = sum / static_cast<float>(count);
    }
  return smoothed;
}

std::vector<DsoCandidate> select_in_cells(const DsoImage& image, const cv::Mat& thresholds,
                                          const cv::Mat& usable, int d) {
  const cv::Mat& full = image.levels.front();
  std::vector<DsoCandidate> chosen;
  const int coarsest = std::min(2, static_cast<int>(image.levels.size()) - 1);
  for (int y4 = 0; y4 < full.rows; y4 += 4 * d)
    for (int x4 = 0; x4 < full.cols; x4 += 4 * d) {
      const std::size_t before4 = chosen.size();
      for (int y2 = y4; y2 < std::min(y4 + 4 * d, full.rows); y2 += 2 * d)
        for (int x2 = x4; x2 < std::min(x4 + 4 * d, full.cols); x2 += 2 * d) {
          const std::size_t before2 = chosen.size();
          for (int y = y2; y < std::min(y2 + 2 * d, full.rows); y += d)
            for (int x = x2; x < std::min(x2 + 2 * d, full.cols); x += d)
              if (const DsoCandidate one = steepest(image, thresholds, usable, x, y, d, 0, 1.0F); one.x >= 0)
                chosen.push_back(one);
          if (chosen.size() > before2 || coarsest < 1) continue;
          if (const DsoCandidate one = steepest(image, thresholds, usable, x2, y2, 2 * d, 1, kCoarser);
              one.x >= 0)
            chosen.push_back(one);
        }
      if (chosen.size() > before4 || coarsest < 2) continue;
      if (const DsoCandidate one = steepest(image, thresholds, usable, x4, y4, 4 * d, 2, kCoarser * kCoarser);
          one.x >= 0)
        chosen.push_back(one);
    }
  return chosen;
}

std::vector<DsoCandidate> select_candidates(const DsoImage& image, const cv::Mat& thresholds,
                                            const cv::Mat& usable, int wanted, int& d) {
  // A few rounds do, for the last frame's cells nearly fit. Cells of more px would leave whole walls bare.
  constexpr int kTries = 3, kMost = 64;
  constexpr double kEnough = 0.75, kTooMany = 1.25;  // shares of the number wanted, between which it will do
  std::vector<DsoCandidate> chosen;
  for (int i = 0; i < kTries; ++i) {
    chosen = select_in_cells(image, thresholds, usable, d);
    const double share = static_cast<double>(chosen.size()) / wanted;
    if (share >= kEnough && share <= kTooMany) break;
    // Their number goes with 1 / (d + 1)², roughly.
    const int next =
        std::clamp(static_cast<int>(std::lround(std::sqrt(std::max(share, 0.01)) * (d + 1))) - 1, 1, kMost);
    if (next == d) break;
    d = next;
  }
  // Too many are thinned evenly.
  if (static_cast<double>(chosen.size()) > kTooMany * wanted) {
    std::vector<DsoCandidate> fewer;
    const std::size_t count = chosen.size(), least = static_cast<std::size_t>(wanted);
    for (std::size_t i = 0; i < count; ++i)
      if (i * least / count != (i + 1) * least / count) fewer.push_back(chosen[i]);
    chosen = std::move(fewer);
  }
  return chosen;
}

}  // namespace stillpoint
