#include "core/odometry/orb_extractor.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <future>
#include <numeric>
#include <opencv2/imgproc.hpp>

namespace stillpoint {
namespace {

constexpr int kPatchRadius = 15;  // px: the disc of the intensity centroid, and half the descriptor's patch
constexpr int kBorder = 19;    // px: corners keep this far from the level's edge, so that patches stay inside
constexpr int kFastCell = 32;  // px: where FAST finds nothing in such a cell, the low threshold is tried

/// Weights of the intensity centroid's disc: a row of 32 pixels each, from kPatchRadius left of the corner
/// on, so that whole rows are summed at once and what lies outside the disc counts 0.
struct DiscWeights {
  static constexpr int kRow = 2 * kPatchRadius + 2;
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
std::vector<cv::KeyPoint> fast_corners(const cv::Mat& image, const cv::Rect& inside, int threshold, int low) {
  constexpr int kMargin = 3;  // FAST looks this far about a pixel
  const cv::Rect seen(inside.x - kMargin, inside.y - kMargin, inside.width + 2 * kMargin,
                      inside.height + 2 * kMargin);
  std::vector<cv::KeyPoint> corners, faint;
  cv::FAST(image(seen), corners, threshold, true);
  const int columns = (inside.width + kFastCell - 1) / kFastCell,
            rows = (inside.height + kFastCell - 1) / kFastCell;
  std::vector<std::uint8_t> occupied(static_cast<std::size_t>(columns * rows), 0);
  for (auto& corner : corners) {
    const int column = (static_cast<int>(corner.pt.x) - kMargin) / kFastCell;
    const int row = (static_cast<int>(corner.pt.y) - kMargin) / kFastCell;
    occupied[static_cast<std::size_t>(row * columns + column)] = 1;
    corner.pt += cv::Point2f(seen.tl());
  }
  if (low >= threshold) return corners;
  for (int r = 0; r < rows; ++r) {
    const std::uint8_t* of_row = occupied.data() + r * columns;
    for (int c = 0; c < columns; ++c) {
      if (of_row[c]) continue;
      const int first = c;  // empty cells beside each other are searched in one go
      while (c + 1 < columns && !of_row[c + 1]) ++c;
      const cv::Rect strip(seen.x + first * kFastCell, seen.y + r * kFastCell,
                           (c - first + 1) * kFastCell + 2 * kMargin, kFastCell + 2 * kMargin);
      const cv::Rect window = strip & seen;
      cv::FAST(image(window), faint, low, true);
      for (auto& corner : faint) {
        corner.pt += cv::Point2f(window.tl());
        corners.push_back(corner);
      }
    }
  }
  return corners;
}

/// Candidates by cell, the best of each first: index into the candidates, and where each cell begins.
struct ByCell {
  std::vector<int> start, index;
};

ByCell sort_by_cell(const std::vector<cv::KeyPoint>& candidates, double side, int width, int height) {
  const int columns = static_cast<int>(width / side) + 1, rows = static_cast<int>(height / side) + 1;
  const auto cell_of = [&](const cv::KeyPoint& candidate) {
    return static_cast<std::size_t>(static_cast<int>(candidate.pt.y / side) * columns +
                                    static_cast<int>(candidate.pt.x / side));
  };
  ByCell cells;
  cells.start.assign(static_cast<std::size_t>(columns * rows) + 1, 0);
  cells.index.resize(candidates.size());
  for (const auto& candidate : candidates) ++cells.start[cell_of(candidate) + 1];
  for (std::size_t c = 1; c < cells.start.size(); ++c) cells.start[c] += cells.start[c - 1];
  std::vector<int> next(cells.start.begin(), cells.start.end() - 1);
  for (std::size_t i = 0; i < candidates.size(); ++i)
    cells.index[static_cast<std::size_t>(next[cell_of(candidates[i])]++)] = static_cast<int>(i);
  for (std::size_t c = 0; c + 1 < cells.start.size(); ++c)
    std::sort(cells.index.begin() + cells.start[c], cells.index.begin() + cells.start[c + 1],
              [&](int a, int b) {
                const float left = candidates[static_cast<std::size_t>(a)].response,
                            right = candidates[static_cast<std::size_t>(b)].response;
                return left != right ? left > right : a < b;
              });
  return cells;
}

}  // namespace

std::vector<cv::KeyPoint> spread(std::vector<cv::KeyPoint> candidates, int wanted, int width, int height) {
  if (static_cast<int>(candidates.size()) <= wanted || wanted <= 0) {
    if (wanted <= 0) candidates.clear();
    return candidates;
  }
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
    float response;
    int index;
    std::size_t cell;
  };
  std::vector<Last> last;
  for (std::size_t c = 0; c < count; ++c)
    if (size_of(c) > rounds) {
      const int index = cells.index[static_cast<std::size_t>(cells.start[c] + rounds)];
      last.push_back({candidates[static_cast<std::size_t>(index)].response, index, c});
    }
  std::nth_element(last.begin(), last.begin() + (wanted - taken), last.end(),
                   [](const Last& a, const Last& b) {
                     return a.response != b.response ? a.response > b.response : a.index < b.index;
                   });
  std::vector<std::uint8_t> one_more(count, 0);
  for (int i = 0; i < wanted - taken; ++i) one_more[last[static_cast<std::size_t>(i)].cell] = 1;

  std::vector<cv::KeyPoint> chosen;
  chosen.reserve(static_cast<std::size_t>(wanted));
  for (std::size_t c = 0; c < count; ++c) {
    const int end = cells.start[c] + std::min(size_of(c), rounds + one_more[c]);
    for (int i = cells.start[c]; i < end; ++i)
      chosen.push_back(candidates[static_cast<std::size_t>(cells.index[static_cast<std::size_t>(i)])]);
  }
  return chosen;
}

OrbExtractor::OrbExtractor(const FeatureConfig& config) : config_(config) {
  // Corners a level in proportion to its side, as ORB does: a geometric series that sums to `count`.
  const double shrink = 1.0 / config.scale_factor;
  double share = config.count * (1.0 - shrink) / (1.0 - std::pow(shrink, config.levels));
  for (int level = 0; level + 1 < config.levels; ++level, share *= shrink) wanted_.push_back(cvRound(share));
  wanted_.push_back(std::max(0, config.count - std::accumulate(wanted_.begin(), wanted_.end(), 0)));
  descriptor_ =
      cv::ORB::create(config.count, 2.0F, 1, kBorder, 0, 2, cv::ORB::FAST_SCORE, 2 * kPatchRadius + 1);
}

std::vector<cv::KeyPoint> OrbExtractor::corners(const cv::Mat& level_image, int wanted) const {
  const cv::Rect inside(kBorder, kBorder, level_image.cols - 2 * kBorder, level_image.rows - 2 * kBorder);
  if (inside.width < 1 || inside.height < 1) return {};
  auto chosen = spread(fast_corners(level_image, inside, config_.fast_threshold, config_.fast_threshold_low),
                       wanted, level_image.cols, level_image.rows);
  for (auto& corner : chosen) {
    corner.angle = centroid_angle(level_image, corner.pt);
    corner.octave = 0;
  }
  return chosen;
}

OrbFeatures OrbExtractor::extract_level(const cv::Mat& level_image, int level, const cv::Size& full) const {
  OrbFeatures features;
  features.keypoints = corners(level_image, wanted_[static_cast<std::size_t>(level)]);
  if (features.keypoints.empty()) return features;
  cv::Mat rows;
  descriptor_->compute(level_image, features.keypoints, rows);
  features.descriptors.resize(features.keypoints.size());
  const double scale = std::pow(config_.scale_factor, level);
  for (std::size_t i = 0; i < features.keypoints.size(); ++i) {
    cv::KeyPoint& keypoint = features.keypoints[i];
    // Pixel centres lie at whole numbers, hence the halves: without them coarse levels sit a pixel off.
    keypoint.pt.x =
        (keypoint.pt.x + 0.5F) * static_cast<float>(full.width) / static_cast<float>(level_image.cols) - 0.5F;
    keypoint.pt.y =
        (keypoint.pt.y + 0.5F) * static_cast<float>(full.height) / static_cast<float>(level_image.rows) -
        0.5F;
    keypoint.octave = level;
    keypoint.size = static_cast<float>((2 * kPatchRadius + 1) * scale);
    std::memcpy(features.descriptors[i].data(), rows.ptr(static_cast<int>(i)), sizeof(Descriptor));
  }
  return features;
}

std::vector<cv::Mat> OrbExtractor::pyramid(const cv::Mat& gray) const {
  std::vector<cv::Mat> levels = {gray};
  double scale = config_.scale_factor;
  for (int level = 1; level < config_.levels; ++level, scale *= config_.scale_factor) {
    const cv::Size size(cvRound(gray.cols / scale), cvRound(gray.rows / scale));
    if (size.width <= 2 * kBorder || size.height <= 2 * kBorder) break;
    cv::Mat smaller;
    cv::resize(levels.back(), smaller, size, 0, 0, cv::INTER_LINEAR);
    levels.push_back(smaller);
  }
  return levels;
}

OrbFeatures OrbExtractor::extract(const cv::Mat& gray, int threads) const {
  std::vector<OrbFeatures> of_level(static_cast<std::size_t>(config_.levels));
  std::vector<cv::Mat> levels;
  std::atomic<std::size_t> next = 1;
  const auto take_levels = [&] {
    for (std::size_t level = next++; level < levels.size(); level = next++)
      of_level[level] = extract_level(levels[level], static_cast<int>(level), gray.size());
  };
  if (threads > 1) {
    // The full image needs no pyramid and is a third of the work: it is begun while the pyramid is made.
    std::future<void> beside;
    std::promise<void> pyramid_made;  // given up before `beside` is waited for, should anything throw
    beside = std::async(std::launch::async, [&, made = pyramid_made.get_future()] {
      of_level[0] = extract_level(gray, 0, gray.size());
      made.wait();
      take_levels();
    });
    levels = pyramid(gray);
    pyramid_made.set_value();
    take_levels();
    beside.get();
  } else {
    levels = pyramid(gray);
    next = 0;
    take_levels();
  }
  OrbFeatures features = std::move(of_level[0]);
  for (std::size_t level = 1; level < of_level.size(); ++level) {
    const OrbFeatures& more = of_level[level];
    features.keypoints.insert(features.keypoints.end(), more.keypoints.begin(), more.keypoints.end());
    features.descriptors.insert(features.descriptors.end(), more.descriptors.begin(), more.descriptors.end());
  }
  return features;
}

}  // namespace stillpoint
