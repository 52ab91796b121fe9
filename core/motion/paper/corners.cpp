#include "core/motion/paper/corners.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "core/motion/paper/corner_candidates.hpp"

namespace stillpoint {
namespace {

/// Which pixels are too near to a chosen one: a bit each.
class Surroundings {
 public:
  Surroundings(const cv::Size& size, double distance_px)
      : size_(size),
        words_(static_cast<std::size_t>((size.width + kWordBits - 1) / kWordBits)),
        taken_(static_cast<std::size_t>(size.height) * words_, 0) {
    const double squared = distance_px * distance_px;
    for (int down = 0; down * down < squared; ++down) {
      int across = 0;
      while ((across + 1) * (across + 1) + down * down < squared) ++across;
      reach_.push_back(across);
    }
  }

  [[nodiscard]] bool is_free(const cv::Point& at) const {
    return (row(at.y)[at.x / kWordBits] >> (at.x % kWordBits) & 1) == 0;
  }
  void take(const cv::Point& at) {
    const int furthest = static_cast<int>(reach_.size()) - 1;
    for (int y = std::max(at.y - furthest, 0); y <= std::min(at.y + furthest, size_.height - 1); ++y) {
      const int across = reach_[static_cast<std::size_t>(std::abs(y - at.y))];
      take_run(y, std::max(at.x - across, 0), std::min(at.x + across, size_.width - 1));
    }
  }

 private:
  using Word = std::uint64_t;
  static constexpr int kWordBits = 64;  // pixels a word

  [[nodiscard]] const Word* row(int y) const { return taken_.data() + static_cast<std::size_t>(y) * words_; }

  void take_run(int y, int first, int last) {
    Word* words = taken_.data() + static_cast<std::size_t>(y) * words_;
    const Word from_first = ~Word{0} << (first % kWordBits);
    const Word to_last = ~Word{0} >> (kWordBits - 1 - last % kWordBits);
    const int begin = first / kWordBits, end = last / kWordBits;
    if (begin == end) {
      words[begin] |= from_first & to_last;
      return;
    }
    words[begin] |= from_first;
    std::fill(words + begin + 1, words + end, ~Word{0});
    words[end] |= to_last;
  }

  cv::Size size_;
  std::size_t words_;
  std::vector<Word> taken_;
  std::vector<int> reach_;  ///< px to either side, so many rows above and below
};

}  // namespace

std::vector<cv::Point2f> find_corners(const cv::Mat& gradients, int max_corners, double quality,
                                      double distance_px) {
  std::vector<cv::Point2f> corners;
  Surroundings chosen(gradients.size(), distance_px);
  for (const auto& [at, response] : corner_candidates(gradients, quality)) {
    if (!chosen.is_free(at)) continue;
    chosen.take(at);
    corners.emplace_back(at);
    if (corners.size() == static_cast<std::size_t>(max_corners)) break;
  }
  return corners;
}

}  // namespace stillpoint
