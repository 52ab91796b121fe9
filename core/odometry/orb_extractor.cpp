#include "core/odometry/orb_extractor.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <future>
#include <numeric>

#include "core/geometry/pixel_conventions.hpp"
#include "core/odometry/fast_corners.hpp"
#include "core/odometry/orb_descriptors.hpp"
#include "core/odometry/smaller_level.hpp"

namespace stillpoint {
namespace {

constexpr int kPatchRadius = kOrbPatchRadius;  // px: that of the intensity centroid's disc, too
constexpr int kBorder = kOrbBorder;
constexpr int kFastCell = 32;  // px: where FAST finds nothing in such a cell, the low threshold is tried

/// Weights of the intensity centroid's disc: a row of 32 pixels each, from kPatchRadius left of the corner
/// on, so that whole rows are summed at once and what lies outside the disc counts 0.
struct DiscWeights {
  static constexpr int kRow = 2 * kPatchRadius + 2;  // px: the disc and one more, 32 in all
  std::array<std::array<std::int16_t, kRow>, 2 * kPatchRadius + 1> inside{}, sideways{};

  DiscWeights() {
    for (int v = -kPatchRadius; v <= kPatchRadius; ++v) {
      const int half = static_cast<int>(std::sqrt(double(kPatchRadius * kPatchRadius - v * v)));
      for (int u = -half; u <= half; ++u) {
        const auto row = static_cast<std::size_t>(v + kPatchRadius),
                   column = static_cast<std::size_t>(u + kPatchRadius);
        inside[row][column] = 1;
        sideways[row][column] = static_cast<std::int16_t>(u);
      }
    }
  }
};

/// The direction from the corner to the intensity centroid of its disc, degrees in [0, 360).
float centroid_angle(const cv::Mat& image, const cv::Point2f& corner) {
  static const DiscWeights weights;
  const int left = cvRound(corner.x) - kPatchRadius, cy = cvRound(corner.y);
  int m10 = 0, m01 = 0;
  for (int v = -kPatchRadius; v <= kPatchRadius; ++v) {
    const uchar* row = image.ptr<uchar>(cy + v) + left;
    const auto& inside = weights.inside[static_cast<std::size_t>(v + kPatchRadius)];
    const auto& sideways = weights.sideways[static_cast<std::size_t>(v + kPatchRadius)];
    int sum = 0, moment = 0;
    for (std::size_t u = 0; u < DiscWeights::kRow; ++u) {
      const auto pixel = static_cast<std::int16_t>(row[u]);
      sum += pixel * inside[u];
      moment += pixel * sideways[u];
    }
    m10 += moment;
    m01 += v * sum;
  }
  return cv::fastAtan2(static_cast<float>(m01), static_cast<float>(m10));
}

/// FAST corners inside `inside`, at the low threshold in cells that have none at the high one.
void fast_corners(const cv::Mat& image, const cv::Rect& inside, int threshold, int low,
                  std::vector<cv::KeyPoint>& corners) {
  corners.clear();
  append_fast_corners(image, inside, threshold, corners);
  if (low >= threshold) return;
  const int columns = (inside.width + kFastCell - 1) / kFastCell,
            rows = (inside.height + kFastCell - 1) / kFastCell;
  cv::AutoBuffer<std::uint8_t> occupied(static_cast<std::size_t>(columns * rows));
  std::fill_n(occupied.data(), occupied.size(), std::uint8_t{0});
  for (const auto& corner : corners) {
    const int column = (static_cast<int>(corner.pt.x) - inside.x) / kFastCell;
    const int row = (static_cast<int>(corner.pt.y) - inside.y) / kFastCell;
    occupied[static_cast<std::size_t>(row * columns + column)] = 1;
  }
  for (int r = 0; r < rows; ++r) {
    const std::uint8_t* of_row = occupied.data() + r * columns;
    for (int c = 0; c < columns; ++c) {
      if (of_row[c]) continue;
      const int first = c;  // empty cells beside each other are searched in one go
      while (c + 1 < columns && !of_row[c + 1]) ++c;
      const cv::Rect strip(inside.x + first * kFastCell, inside.y + r * kFastCell,
                           (c - first + 1) * kFastCell, kFastCell);
      append_fast_corners(image, strip & inside, low, corners);
    }
  }
}

/// A candidate and which of them it is.
struct Ranked {
  float response;
  int index;
  [[nodiscard]] bool before(const Ranked& other) const {
    return response != other.response ? response > other.response : index < other.index;
  }
};

/// Candidates by cell, the best of each first, and where each cell begins.
struct ByCell {
  std::vector<int> start;
  std::vector<Ranked> candidates;
};

ByCell sort_by_cell(const std::vector<cv::KeyPoint>& candidates, double side, int width, int height) {
  const int columns = static_cast<int>(width / side) + 1, rows = static_cast<int>(height / side) + 1;
  ByCell cells;
  cells.start.assign(static_cast<std::size_t>(columns * rows) + 1, 0);
  std::vector<std::size_t> cell_of(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    cell_of[i] = static_cast<std::size_t>(static_cast<int>(candidates[i].pt.y / side) * columns +
                                          static_cast<int>(candidates[i].pt.x / side));
    ++cells.start[cell_of[i] + 1];
  }
  for (std::size_t c = 1; c < cells.start.size(); ++c) cells.start[c] += cells.start[c - 1];
  std::vector<int> next(cells.start.begin(), cells.start.end() - 1);
  cells.candidates.resize(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i)
    cells.candidates[static_cast<std::size_t>(next[cell_of[i]]++)] = {candidates[i].response,
                                                                      static_cast<int>(i)};
  for (std::size_t c = 0; c + 1 < cells.start.size(); ++c)
    std::sort(cells.candidates.begin() + cells.start[c], cells.candidates.begin() + cells.start[c + 1],
              [](const Ranked& a, const Ranked& b) { return a.before(b); });
  return cells;
}

}  // namespace

std::vector<cv::KeyPoint> spread(const std::vector<cv::KeyPoint>& candidates, int wanted, int width,
                                 int height) {
  if (wanted <= 0) return {};
  if (static_cast<int>(candidates.size()) <= wanted) return candidates;
  const double side = std::max(1.0, std::sqrt(static_cast<double>(width) * height / wanted));
  const ByCell cells = sort_by_cell(candidates, side, width, height);
  const std::size_t count = cells.start.size() - 1;
  const auto size_of = [&](std::size_t cell) { return cells.start[cell + 1] - cells.start[cell]; };

  // As many whole rounds as there is room for; of the next round the best.
  int rounds = 0, taken = 0;
  for (int in_round = 0;; ++rounds, taken += in_round) {
    in_round = 0;
    for (std::size_t c = 0; c < count; ++c) in_round += size_of(c) > rounds;
    if (taken + in_round > wanted) break;
  }
  struct Last {
    Ranked candidate;
    std::size_t cell;
  };
  std::vector<Last> last;
  last.reserve(count);
  for (std::size_t c = 0; c < count; ++c)
    if (size_of(c) > rounds)
      last.push_back({cells.candidates[static_cast<std::size_t>(cells.start[c] + rounds)], c});
  std::nth_element(last.begin(), last.begin() + (wanted - taken), last.end(),
                   [](const Last& a, const Last& b) { return a.candidate.before(b.candidate); });
  std::vector<std::uint8_t> one_more(count, 0);
  for (int i = 0; i < wanted - taken; ++i) one_more[last[static_cast<std::size_t>(i)].cell] = 1;

  std::vector<cv::KeyPoint> chosen;
  chosen.reserve(static_cast<std::size_t>(wanted));
  for (std::size_t c = 0; c < count; ++c) {
    const int end = cells.start[c] + std::min(size_of(c), rounds + one_more[c]);
    for (int i = cells.start[c]; i < end; ++i)
      chosen.push_back(
          candidates[static_cast<std::size_t>(cells.candidates[static_cast<std::size_t>(i)].index)]);
  }
  return chosen;
}

OrbExtractor::OrbExtractor(const FeatureConfig& config) : config_(config) {
  // Corners a level in proportion to its side, as ORB does: a geometric series that sums to `count`.
  const double shrink = 1.0 / config.scale_factor;
  double share = config.count * (1.0 - shrink) / (1.0 - std::pow(shrink, config.levels));
  for (int level = 0; level + 1 < config.levels; ++level, share *= shrink) wanted_.push_back(cvRound(share));
  wanted_.push_back(std::max(0, config.count - std::accumulate(wanted_.begin(), wanted_.end(), 0)));
}

void OrbExtractor::find_corners(int wanted, Level& level) const {
  const cv::Mat& image = level.image;
  auto& keypoints = level.found.keypoints;
  keypoints.clear();
  const cv::Rect inside(kBorder, kBorder, image.cols - 2 * kBorder, image.rows - 2 * kBorder);
  if (inside.width < 1 || inside.height < 1) return;
  fast_corners(image, inside, config_.fast_threshold, config_.fast_threshold_low, level.candidates);
  keypoints = spread(level.candidates, wanted, image.cols, image.rows);
  for (auto& corner : keypoints) {
    corner.angle = centroid_angle(image, corner.pt);
    corner.octave = 0;
  }
}

void OrbExtractor::extract_level(int index, const cv::Size& full, Level& level) const {
  OrbFeatures& found = level.found;
  find_corners(wanted_[static_cast<std::size_t>(index)], level);
  describe_corners(level.image, found.keypoints, level.blurred, found.descriptors);
  const double scale = std::pow(config_.scale_factor, index);
  for (std::size_t i = 0; i < found.keypoints.size(); ++i) {
    cv::KeyPoint& keypoint = found.keypoints[i];
    keypoint.pt.x = to_pixel(to_raster(keypoint.pt.x) * static_cast<float>(full.width) /
                             static_cast<float>(level.image.cols));
    keypoint.pt.y = to_pixel(to_raster(keypoint.pt.y) * static_cast<float>(full.height) /
                             static_cast<float>(level.image.rows));
    keypoint.octave = index;
    keypoint.size = static_cast<float>((2 * kPatchRadius + 1) * scale);
  }
}

int OrbExtractor::fill_pyramid(const cv::Size& full, std::vector<Level>& levels) const {
  double scale = config_.scale_factor;
  int level = 1;
  for (; level < config_.levels; ++level, scale *= config_.scale_factor) {
    const cv::Size size(cvRound(full.width / scale), cvRound(full.height / scale));
    if (size.width <= 2 * kBorder || size.height <= 2 * kBorder) break;
    const auto at = static_cast<std::size_t>(level);
    make_smaller_level(levels[at - 1].image, size, levels[at].image);
  }
  return level;
}

OrbFeatures OrbExtractor::extract(const cv::Mat& gray, int threads) const {
  std::vector<Level> levels(static_cast<std::size_t>(config_.levels));
  levels[0].image = gray;
  std::atomic<int> next = 1;
  int count = 0;
  const auto take_levels = [&] {
    for (int level = next++; level < count; level = next++)
      extract_level(level, gray.size(), levels[static_cast<std::size_t>(level)]);
  };
  if (threads > 1) {
    // The full image needs no pyramid and is a third of the work: it is begun while the pyramid is made.
    std::future<void> beside;
    std::promise<void> pyramid_made;  // given up before `beside` is waited for, should anything throw
    beside = std::async(std::launch::async, [&, made = pyramid_made.get_future()] {
      extract_level(0, gray.size(), levels[0]);
      made.wait();
      take_levels();
    });
    count = fill_pyramid(gray.size(), levels);
    pyramid_made.set_value();
    take_levels();
    beside.get();
  } else {
    count = fill_pyramid(gray.size(), levels);
    next = 0;
    take_levels();
  }
  std::size_t total = 0;
  for (int level = 0; level < count; ++level)
    total += levels[static_cast<std::size_t>(level)].found.keypoints.size();
  OrbFeatures features;
  features.keypoints.reserve(total);
  features.descriptors.reserve(total);
  for (int level = 0; level < count; ++level) {
    const OrbFeatures& more = levels[static_cast<std::size_t>(level)].found;
    features.keypoints.insert(features.keypoints.end(), more.keypoints.begin(), more.keypoints.end());
    features.descriptors.insert(features.descriptors.end(), more.descriptors.begin(), more.descriptors.end());
  }
  return features;
}

}  // namespace stillpoint
