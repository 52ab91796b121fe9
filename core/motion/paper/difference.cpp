#include "core/motion/paper/difference.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/motion/paper/difference_wide.hpp"

namespace stillpoint {
namespace {

// Ratios of grey levels: exposure hardly changes by more between two frames.
constexpr double kLeastRatio = 0.5, kMostRatio = 2.0;

/// Every other pixel of a row from an even pixel on, eight at once.
/// @return how far it came
int count_ratios_by_eight(const uchar* to, const uchar* from, const uchar* usable, int begin, int width,
                          RatioCounts& counts) {
  const auto even_pixels = [](const uchar* pixels) {
    return cv::v_reinterpret_as_s16(cv::v_load(pixels)) & cv::v_setall_s16(0xFF);
  };
  const auto is_mid = [](const cv::v_int16x8& gray) {
    return (gray >= cv::v_setall_s16(kDark)) & (gray <= cv::v_setall_s16(kBright));
  };
  const auto times = [](const cv::v_int16x8& gray, short factor) {
    return cv::v_mul_wrap(gray, cv::v_setall_s16(factor));
  };
  cv::v_int16x8 all = cv::v_setzero_s16(), darker = all, brighter = all;
  int x = begin;
  for (; x + 16 <= width; x += 16) {
    const cv::v_int16x8 a = even_pixels(to + x), b = even_pixels(from + x);
    const cv::v_int16x8 tells = (even_pixels(usable + x) != cv::v_setzero_s16()) & is_mid(a) & is_mid(b) &
                                (times(a, 2) >= b) & (a < times(b, 2));  // kLeastRatio, kMostRatio
    all -= tells;                                                        // a mask is -1
    darker -= tells & (times(a, 50) < times(b, 49));                     // less than 0.98
    brighter -= tells & (times(a, 50) >= times(b, 51));                  // 1.02 or more
  }
  counts.all += cv::v_reduce_sum(all);
  counts.darker += cv::v_reduce_sum(darker);
  counts.brighter += cv::v_reduce_sum(brighter);
  return x;
}

void count_ratios(const uchar* to, const uchar* from, const uchar* usable, int width,
                  [[maybe_unused]] bool wide, RatioCounts& counts) {
  int x = 0;
#if defined(__x86_64__)
  if (wide) x = count_ratios_wide(to, from, usable, width, counts);
#endif
  x = count_ratios_by_eight(to, from, usable, x, width, counts);
  for (; x < width; x += 2) {
    const int a = to[x], b = from[x];
    if (usable[x] == 0 || std::min(a, b) < kDark || std::max(a, b) > kBright || 2 * a < b || a >= 2 * b)
      continue;
    ++counts.all;
    if (50 * a < 49 * b) ++counts.darker;
    if (50 * a >= 51 * b) ++counts.brighter;
  }
}

/// The ratios of two grey levels, in bins: dividing every pixel by another one takes longer than looking up.
class RatioBins {
 public:
  static constexpr std::uint16_t kCount = 3000;  ///< of 0.0005; also the bin of what tells nothing

  RatioBins() {
    bins_.fill(kCount);
    for (int from = kDark; from <= kBright; ++from)
      for (int to = kDark; to <= kBright; ++to) {
        const double ratio = static_cast<double>(to) / from;
        if (ratio >= kLeastRatio && ratio < kMostRatio)
          bins_[static_cast<std::size_t>(from << 8 | to)] =
              static_cast<std::uint16_t>((ratio - kLeastRatio) / (kMostRatio - kLeastRatio) * kCount);
      }
  }
  [[nodiscard]] std::size_t of(unsigned char to, unsigned char from) const {
    return bins_[static_cast<std::size_t>(from << 8 | to)];
  }
  static double middle(std::size_t bin) {
    return kLeastRatio + (static_cast<double>(bin) + 0.5) * (kMostRatio - kLeastRatio) / kCount;
  }

 private:
  std::array<std::uint16_t, 1 << 16> bins_;
};

}  // namespace

cv::Mat frame_difference(const cv::Mat& destination, const cv::Mat& compensated, const cv::Mat& valid,
                         [[maybe_unused]] bool wide) {
  cv::Mat difference(destination.size(), CV_8UC1);
  for (int y = 0; y < difference.rows; ++y) {
    const uchar *there = destination.ptr(y), *carried = compensated.ptr(y), *usable = valid.ptr(y);
    uchar* to = difference.ptr(y);
    int x = 0;
#if defined(__x86_64__)
    if (wide) x = differences_wide(there, carried, usable, difference.cols, to);
#endif
    for (; x + cv::v_uint8x16::nlanes <= difference.cols; x += cv::v_uint8x16::nlanes)
      cv::v_store(to + x,
                  cv::v_absdiff(cv::v_load(there + x), cv::v_load(carried + x)) & cv::v_load(usable + x));
    for (; x < difference.cols; ++x) to[x] = static_cast<uchar>(std::abs(there[x] - carried[x]) & usable[x]);
  }
  return difference;
}

double exposure_ratio(const cv::Mat& destination, const cv::Mat& compensated, const cv::Mat& valid,
                      bool wide) {
  RatioCounts counts;
  for (int y = 0; y < destination.rows; y += 2)
    count_ratios(destination.ptr(y), compensated.ptr(y), valid.ptr(y), destination.cols, wide, counts);
  if (counts.all * 40 < static_cast<int>(destination.total())) return 1.0;  // of every fourth pixel
  if (2 * counts.darker < counts.all && 2 * counts.brighter <= counts.all) return 1.0;

  static const RatioBins bins;
  std::vector<int> ratios(RatioBins::kCount + 1, 0);
  for (int y = 0; y < destination.rows; y += 2) {
    const uchar *to = destination.ptr(y), *from = compensated.ptr(y), *usable = valid.ptr(y);
    for (int x = 0; x < destination.cols; x += 2)
      ++ratios[usable[x] != 0 ? bins.of(to[x], from[x]) : RatioBins::kCount];
  }
  int below = 0;
  std::size_t bin = 0;
  while (bin + 1 < RatioBins::kCount && 2 * (below += ratios[bin]) < counts.all) ++bin;
  return RatioBins::middle(bin);
}

Histogram histogram(const cv::Mat& image, const cv::Mat& valid) {
  // Pairs of levels below kPairLevels are counted at once, which nearly all of a difference's are; those of a
  // word in a table each, for neighbours are often alike and would wait for one another's count. What is not
  // valid is counted as black, and taken off again.
  constexpr unsigned kPairBits = 5, kPairLevels = 1 << kPairBits;
  constexpr std::uint64_t kAbovePairs = 0x0101010101010101U * (0xFF ^ (kPairLevels - 1));
  constexpr std::uint64_t kFirsts = 0x0001000100010001U * (kPairLevels - 1);
  std::array<std::array<int, kPairLevels * kPairLevels>, 4> pairs{};
  std::array<Histogram, 8> tables{};
  for (int y = 0; y < image.rows; ++y) {
    const unsigned char* pixels = image.ptr(y);
    const unsigned char* usable = valid.ptr(y);
    int x = 0;
    for (; x + 8 <= image.cols; x += 8) {
      std::uint64_t eight = 0, usable_eight = 0;
      std::memcpy(&eight, pixels + x, 8);
      std::memcpy(&usable_eight, usable + x, 8);
      eight &= usable_eight;
      if ((eight & kAbovePairs) == 0) {
        const std::uint64_t four = (eight & kFirsts) | (eight >> (8 - kPairBits) & kFirsts << kPairBits);
        for (std::size_t k = 0; k < 4; ++k) ++pairs[k][four >> (16 * k) & 0xFFFF];
      } else {
        for (std::size_t k = 0; k < 8; ++k) ++tables[k][eight >> (8 * k) & 0xFF];
      }
    }
    for (; x < image.cols; ++x) ++tables[0][static_cast<std::size_t>(pixels[x] & usable[x])];
  }
  Histogram levels{};
  for (const Histogram& table : tables)
    for (std::size_t level = 0; level < levels.size(); ++level) levels[level] += table[level];
  for (const auto& table : pairs)
    for (std::size_t pair = 0; pair < table.size(); ++pair) {
      levels[pair % kPairLevels] += table[pair];
      levels[pair / kPairLevels] += table[pair];
    }
  levels[0] -= static_cast<int>(valid.total()) - cv::countNonZero(valid);
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

cv::Mat binarise(const cv::Mat& difference, double threshold, bool wide) {
  cv::Mat mask;
  const double least = std::floor(threshold) + 1.0;
  if (!wide || !(least >= 0.0 && least <= 255.0)) {
    cv::threshold(difference, mask, threshold, 255, cv::THRESH_BINARY);
    return mask;
  }
  mask.create(difference.size(), CV_8UC1);
  const auto bound = static_cast<uchar>(least);
  for (int y = 0; y < mask.rows; ++y) {
    const uchar* pixels = difference.ptr(y);
    uchar* to = mask.ptr(y);
    int x = 0;
#if defined(__x86_64__)
    x = binarise_wide(pixels, mask.cols, bound, to);
#endif
    for (; x < mask.cols; ++x) to[x] = pixels[x] >= bound ? 255 : 0;
  }
  return mask;
}

}  // namespace stillpoint
