#include "core/motion/paper/difference.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace stillpoint {

cv::Mat frame_difference(const cv::Mat& destination, const cv::Mat& compensated, const cv::Mat& valid) {
  cv::Mat difference;
  cv::absdiff(destination, compensated, difference);
  cv::bitwise_and(difference, valid, difference);  // valid is 0 or 255: a byte-wise selection
  return difference;
}

double exposure_ratio(const cv::Mat& destination, const cv::Mat& compensated, const cv::Mat& valid) {
  constexpr int kDark = 48, kBright = 215;  // grey levels: coarse steps below, cut off above
  constexpr double kLeast = 0.5, kMost = 2.0, kTold = 0.02;
  constexpr std::size_t kBins = 3000;  // of 0.0005
  std::vector<int> ratios(kBins, 0);
  int count = 0;
  for (int y = 0; y < destination.rows; y += 2) {
    const uchar *to = destination.ptr(y), *from = compensated.ptr(y), *usable = valid.ptr(y);
    for (int x = 0; x < destination.cols; x += 2) {
      if (usable[x] == 0 || from[x] < kDark || from[x] > kBright || to[x] < kDark || to[x] > kBright)
        continue;
      const double ratio = static_cast<double>(to[x]) / from[x];
      if (ratio < kLeast || ratio >= kMost) continue;
      ++ratios[static_cast<std::size_t>((ratio - kLeast) / (kMost - kLeast) * static_cast<double>(kBins))];
      ++count;
    }
  }
  if (count * 40 < static_cast<int>(destination.total())) return 1.0;  // every fourth pixel was looked at
  int below = 0;
  std::size_t bin = 0;
  while (bin + 1 < kBins && 2 * (below += ratios[bin]) < count) ++bin;
  const double median =
      kLeast + (static_cast<double>(bin) + 0.5) * (kMost - kLeast) / static_cast<double>(kBins);
  return std::abs(median - 1.0) > kTold ? median : 1.0;
}

Histogram histogram(const cv::Mat& image, const cv::Mat& valid) {
  // Four tables, for neighbouring pixels are often alike and would wait for one another's count; level 256
  // takes the pixels that are not valid.
  std::array<std::array<int, 257>, 4> tables{};
  for (int y = 0; y < image.rows; ++y) {
    const unsigned char* pixels = image.ptr(y);
    const unsigned char* usable = valid.ptr(y);
    for (int x = 0; x < image.cols; ++x)
      ++tables[static_cast<std::size_t>(x) % 4][usable[x] != 0 ? pixels[x] : 256U];
  }
  Histogram levels{};
  for (const auto& table : tables)
    for (std::size_t level = 0; level < levels.size(); ++level) levels[level] += table[level];
  return levels;
}

int otsu_threshold(const Histogram& levels) {
  double total = 0.0, total_sum = 0.0;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    total += levels[level];
    total_sum += static_cast<double>(level) * levels[level];
  }
  int best_level = 0;
  double best_variance = 0.0, below = 0.0, below_sum = 0.0;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    below += levels[level];
    below_sum += static_cast<double>(level) * levels[level];
    const double above = total - below;
    if (below == 0.0 || above == 0.0) continue;
    const double gap = below_sum / below - (total_sum - below_sum) / above;
    const double variance = below * above * gap * gap;  // times total², which no comparison needs
    if (variance > best_variance) {
      best_variance = variance;
      best_level = static_cast<int>(level);
    }
  }
  return best_level;
}

cv::Mat binarise(const cv::Mat& difference, double threshold) {
  cv::Mat mask;
  cv::threshold(difference, mask, threshold, 255, cv::THRESH_BINARY);
  return mask;
}

}  // namespace stillpoint
