#include "core/odometry/orb_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>
#include <opencv2/imgproc.hpp>

namespace stillpoint {
namespace {

constexpr int kPatchRadius = 15;  // px: the disc of the intensity centroid, and half the descriptor's patch
constexpr int kBorder = 19;    // px: corners keep this far from the level's edge, so that patches stay inside
constexpr int kFastCell = 32;  // px: where FAST finds nothing in such a cell, the low threshold is tried

/// For each row of the disc, how far it reaches sideways.
std::array<int, kPatchRadius + 1> disc_half_widths() {
  std::array<int, kPatchRadius + 1> widths{};
  for (int v = 0; v <= kPatchRadius; ++v)
    widths[static_cast<std::size_t>(v)] =
        static_cast<int>(std::sqrt(double(kPatchRadius * kPatchRadius - v * v)));
  return widths;
}

/// The direction from the corner to the intensity centroid of its disc, degrees in [0, 360).
float centroid_angle(const cv::Mat& image, const cv::Point2f& corner) {
  static const auto widths = disc_half_widths();
  const int cx = cvRound(corner.x), cy = cvRound(corner.y);
  int m10 = 0, m01 = 0;
  for (int v = -kPatchRadius; v <= kPatchRadius; ++v) {
    const uchar* row = image.ptr<uchar>(cy + v) + cx;
    const int half = widths[static_cast<std::size_t>(std::abs(v))];
    int sum = 0;
    for (int u = -half; u <= half; ++u) {
      sum += row[u];
      m10 += u * row[u];
    }
    m01 += v * sum;
  }
  return cv::fastAtan2(static_cast<float>(m01), static_cast<float>(m10));
}

/// FAST corners inside `inside`, at the low threshold in cells that have none at the high one.
std::vector<cv::KeyPoint> fast_corners(const cv::Mat& image, const cv::Rect& inside, int threshold, int low) {
  constexpr int kMargin = 3;  // FAST looks this far about a pixel
  const cv::Rect seen(inside.x - kMargin, inside.y - kMargin, inside.width + 2 * kMargin,
                      inside.height + 2 * kMargin);
  std::vector<cv::KeyPoint> corners, cell_corners;
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
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      if (occupied[static_cast<std::size_t>(r * columns + c)]) continue;
      const cv::Rect cell(seen.x + c * kFastCell, seen.y + r * kFastCell, kFastCell + 2 * kMargin,
                          kFastCell + 2 * kMargin);
      const cv::Rect window = cell & seen;
      cv::FAST(image(window), cell_corners, low, true);
      for (auto& corner : cell_corners) {
        corner.pt += cv::Point2f(window.tl());
        corners.push_back(corner);
      }
    }
  return corners;
}

}  // namespace

std::vector<cv::KeyPoint> spread(std::vector<cv::KeyPoint> candidates, int wanted, int width, int height) {
  if (static_cast<int>(candidates.size()) <= wanted || wanted <= 0) {
    if (wanted <= 0) candidates.clear();
    return candidates;
  }
  const double side = std::max(1.0, std::sqrt(static_cast<double>(width) * height / wanted));
  const int columns = static_cast<int>(width / side) + 1;
  struct Candidate {
    int cell, index;
    int rank = 0;  // 0 for the best of its cell
  };
  std::vector<Candidate> order(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto& p = candidates[i].pt;
    order[i] = {static_cast<int>(p.y / side) * columns + static_cast<int>(p.x / side), static_cast<int>(i)};
  }
  const auto response = [&](const Candidate& c) {
    return candidates[static_cast<std::size_t>(c.index)].response;
  };
  std::sort(order.begin(), order.end(), [&](const Candidate& a, const Candidate& b) {
    if (a.cell != b.cell) return a.cell < b.cell;
    if (response(a) != response(b)) return response(a) > response(b);
    return a.index < b.index;
  });
  for (std::size_t i = 1; i < order.size(); ++i)
    order[i].rank = order[i].cell == order[i - 1].cell ? order[i - 1].rank + 1 : 0;
  const auto better = [&](const Candidate& a, const Candidate& b) {
    if (a.rank != b.rank) return a.rank < b.rank;
    if (response(a) != response(b)) return response(a) > response(b);
    return a.index < b.index;
  };
  std::nth_element(order.begin(), order.begin() + wanted, order.end(), better);
  order.resize(static_cast<std::size_t>(wanted));
  std::sort(order.begin(), order.end(), [](const Candidate& a, const Candidate& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.rank < b.rank;
  });
  std::vector<cv::KeyPoint> chosen;
  chosen.reserve(order.size());
  for (const auto& c : order) chosen.push_back(candidates[static_cast<std::size_t>(c.index)]);
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

OrbFeatures OrbExtractor::extract(const cv::Mat& gray) const {
  OrbFeatures features;
  cv::Mat image = gray, rows;
  double scale = 1.0;
  for (int level = 0; level < config_.levels; ++level, scale *= config_.scale_factor) {
    if (level > 0) {
      const cv::Size size(cvRound(gray.cols / scale), cvRound(gray.rows / scale));
      if (size.width <= 2 * kBorder || size.height <= 2 * kBorder) break;
      cv::Mat smaller;
      cv::resize(image, smaller, size, 0, 0, cv::INTER_LINEAR);
      image = smaller;
    }
    auto level_corners = corners(image, wanted_[static_cast<std::size_t>(level)]);
    if (level_corners.empty()) continue;
    descriptor_->compute(image, level_corners, rows);
    for (int i = 0; i < rows.rows; ++i) {
      cv::KeyPoint keypoint = level_corners[static_cast<std::size_t>(i)];
      // Pixel centres lie at whole numbers, hence the halves: without them coarse levels sit a pixel off.
      keypoint.pt.x =
          (keypoint.pt.x + 0.5F) * static_cast<float>(gray.cols) / static_cast<float>(image.cols) - 0.5F;
      keypoint.pt.y =
          (keypoint.pt.y + 0.5F) * static_cast<float>(gray.rows) / static_cast<float>(image.rows) - 0.5F;
      keypoint.octave = level;
      keypoint.size = static_cast<float>((2 * kPatchRadius + 1) * scale);
      features.keypoints.push_back(keypoint);
      Descriptor descriptor;
      std::memcpy(descriptor.data(), rows.ptr(i), sizeof descriptor);
      features.descriptors.push_back(descriptor);
    }
  }
  return features;
}

}  // namespace stillpoint
