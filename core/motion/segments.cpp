#include "core/motion/segments.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace stillpoint {
namespace {

constexpr int kRounds = 3;            // SLIC has settled by then
constexpr float kDepthScale = 0.05F;  // share of the distance that weighs as much as a patch's side
constexpr int kRelaxations = 15;
constexpr float kMostSay = 2.5F;  // log-odds: the surest patch does not outvote its neighbours

struct Sum {
  double x = 0, y = 0, z = 0;
  int count = 0;
};

std::vector<Segment> seeds(const RgbdView& view, int side) {
  std::vector<Segment> segments;
  for (int y = side / 2; y < view.depth.rows; y += side)
    for (int x = side / 2; x < view.depth.cols; x += side) {
      Segment segment;
      segment.centre = {static_cast<float>(x), static_cast<float>(y)};
      segment.depth = view.depth.at<float>(y, x);
      segments.push_back(segment);
    }
  return segments;
}

/// Distance of a pixel to a patch in units of the patch's side; depth counts by its share of the distance.
float distance(const Segment& segment, int x, int y, float z, float side) {
  const float dx = (static_cast<float>(x) - segment.centre.x) / side;
  const float dy = (static_cast<float>(y) - segment.centre.y) / side;
  const float dz = segment.depth > 0 ? (z - segment.depth) / (kDepthScale * z) : 2.0F;
  return dx * dx + dy * dy + dz * dz;
}

void assign(const RgbdView& view, const std::vector<Segment>& segments, int side, cv::Mat& labels) {
  const int columns = (view.depth.cols + side - 1 - side / 2) / side;
  const int rows = static_cast<int>(segments.size()) / std::max(1, columns);
  for (int y = 0; y < view.depth.rows; ++y)
    for (int x = 0; x < view.depth.cols; ++x) {
      const float z = view.depth.at<float>(y, x);
      int best = -1;
      float best_distance = std::numeric_limits<float>::max();
      if (z > 0) {
        // A patch never wanders far from its seed: only those about the pixel's own cell can have it.
        const int column = std::min(x / side, columns - 1), row = std::min(y / side, rows - 1);
        for (int r = std::max(0, row - 1); r <= std::min(rows - 1, row + 1); ++r)
          for (int c = std::max(0, column - 1); c <= std::min(columns - 1, column + 1); ++c) {
            const int candidate = r * columns + c;
            const float d =
                distance(segments[static_cast<std::size_t>(candidate)], x, y, z, static_cast<float>(side));
            if (d < best_distance) best = candidate, best_distance = d;
          }
      }
      labels.at<int>(y, x) = best;
    }
}

/// How much boundary two patches share on one surface, in pixels: the weight of their agreement.
std::map<std::pair<int, int>, int> shared_boundaries(const RgbdView& view, const cv::Mat& labels) {
  std::map<std::pair<int, int>, int> shared;
  const auto look = [&](int y, int x, int y2, int x2) {
    const int a = labels.at<int>(y, x), b = labels.at<int>(y2, x2);
    if (a < 0 || b < 0 || a == b) return;
    if (same_surface(view.depth.at<float>(y, x), view.depth.at<float>(y2, x2)))
      ++shared[{std::min(a, b), std::max(a, b)}];
  };
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x) {
      if (x + 1 < labels.cols) look(y, x, y, x + 1);
      if (y + 1 < labels.rows) look(y, x, y + 1, x);
    }
  return shared;
}

}  // namespace

std::vector<Segment> segment_surfaces(const RgbdView& view, const DepthMotionConfig& config,
                                      cv::Mat& labels) {
  std::vector<Segment> segments = seeds(view, config.segment_px);
  labels = cv::Mat(view.depth.size(), CV_32SC1, cv::Scalar(-1));
  for (int round = 0; round < kRounds; ++round) {
    assign(view, segments, config.segment_px, labels);
    std::vector<Sum> sums(segments.size());
    for (int y = 0; y < labels.rows; ++y)
      for (int x = 0; x < labels.cols; ++x)
        if (const int label = labels.at<int>(y, x); label >= 0) {
          Sum& sum = sums[static_cast<std::size_t>(label)];
          sum.x += x, sum.y += y, sum.z += view.depth.at<float>(y, x), ++sum.count;
        }
    for (std::size_t i = 0; i < segments.size(); ++i) {
      segments[i].pixels = sums[i].count;
      if (sums[i].count == 0) continue;
      const double n = sums[i].count;
      segments[i].centre = {static_cast<float>(sums[i].x / n), static_cast<float>(sums[i].y / n)};
      segments[i].depth = static_cast<float>(sums[i].z / n);
    }
  }
  return segments;
}

void judge_segments(const RgbdView& view, const cv::Mat& log_odds, const cv::Mat& labels,
                    const DepthMotionConfig& config, std::vector<Segment>& segments) {
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x)
      if (const int label = labels.at<int>(y, x); label >= 0)
        segments[static_cast<std::size_t>(label)].evidence += log_odds.at<float>(y, x);
  for (Segment& segment : segments) {
    if (segment.pixels > 0) segment.evidence /= static_cast<float>(segment.pixels);
    segment.evidence = std::clamp(segment.evidence, -kMostSay, kMostSay);
    segment.log_odds = segment.evidence;
  }

  struct Neighbour {
    std::size_t segment;
    float weight;
  };
  std::vector<std::vector<Neighbour>> neighbours(segments.size());
  for (const auto& [pair, boundary] : shared_boundaries(view, labels)) {
    const auto a = static_cast<std::size_t>(pair.first), b = static_cast<std::size_t>(pair.second);
    const float weight = static_cast<float>(config.smoothing) * static_cast<float>(boundary) /
                         static_cast<float>(config.segment_px);
    neighbours[a].push_back({b, weight});
    neighbours[b].push_back({a, weight});
  }
  for (int i = 0; i < kRelaxations; ++i)
    for (std::size_t s = 0; s < segments.size(); ++s) {
      float sum = segments[s].evidence, weights = 1.0F;
      for (const Neighbour& n : neighbours[s]) {
        sum += n.weight * segments[n.segment].log_odds;
        weights += n.weight;
      }
      segments[s].log_odds = sum / weights;
    }
  for (Segment& segment : segments)
    segment.moving = segment.pixels > 0 && segment.log_odds > static_cast<float>(config.moving_log_odds);
}

}  // namespace stillpoint
