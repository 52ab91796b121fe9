#include "core/motion/segments.hpp"

#include <algorithm>
#include <array>
#include <limits>

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

/// The nine patches that may have the pixels of one row of cells: a patch never wanders far from its seed.
/// What a patch's distance needs stands at every column, so that whole rows are compared at once.
class Candidates {
 public:
  static constexpr std::size_t kCount = 9;
  struct Candidate {
    std::vector<float> x, y, z;
    std::vector<int> label;
  };

  Candidates(int width, int side, int columns, int rows)
      : side_(side), columns_(columns), rows_(rows), width_(static_cast<std::size_t>(width)) {
    for (Candidate& c : candidates_)
      c = {std::vector<float>(width_), std::vector<float>(width_), std::vector<float>(width_),
           std::vector<int>(width_)};
  }

  void gather(const std::vector<Segment>& segments, int row) {
    for (std::size_t k = 0; k < kCount; ++k) {
      Candidate& candidate = candidates_[k];
      const int r = row - 1 + static_cast<int>(k) / 3;
      for (std::size_t x = 0; x < width_; ++x) {
        const int c = std::min(static_cast<int>(x) / side_, columns_ - 1) - 1 + static_cast<int>(k) % 3;
        const bool exists = r >= 0 && r < rows_ && c >= 0 && c < columns_;
        constexpr float kNowhere = 1e9F;  // px
        const Segment* segment = exists ? &segments[static_cast<std::size_t>(r * columns_ + c)] : nullptr;
        candidate.x[x] = segment ? segment->centre.x : kNowhere;
        candidate.y[x] = segment ? segment->centre.y : kNowhere;
        candidate.z[x] = segment ? segment->depth : 0.0F;
        candidate.label[x] = r * columns_ + c;
      }
    }
  }

  [[nodiscard]] const std::array<Candidate, kCount>& all() const { return candidates_; }

 private:
  int side_, columns_, rows_;
  std::size_t width_;
  std::array<Candidate, kCount> candidates_;
};

/// A row's pixels, and the nearest patch found for each so far. Pointers that nothing else points to: the
/// loop over a row is to work on several pixels at once.
struct Row {
  int width = 0;
  float down = 0.0F, by_side = 0.0F;
  const float* __restrict depth = nullptr;
  const float* __restrict by_depth = nullptr;  // 1 / m: what a difference in depth counts
  float* __restrict best = nullptr;
  int* __restrict label = nullptr;
};

/// By place in units of the patch's side, by depth in shares of the distance.
void offer(const Candidates::Candidate& candidate, const Row& row) {
  constexpr float kNoDepth = 2.0F;  // how far in depth a patch lies that has none yet
  const float *__restrict cx = candidate.x.data(), *__restrict cy = candidate.y.data(),
              *__restrict cz = candidate.z.data();
  const int* __restrict label = candidate.label.data();
  for (int x = 0; x < row.width; ++x) {
    const float dx = (static_cast<float>(x) - cx[x]) * row.by_side, dy = (row.down - cy[x]) * row.by_side;
    const float measured = (row.depth[x] - cz[x]) * row.by_depth[x];
    const float dz = cz[x] > 0 ? measured : kNoDepth;
    const float d = dx * dx + dy * dy + dz * dz;
    const bool nearer = d < row.best[x];
    row.best[x] = nearer ? d : row.best[x];
    row.label[x] = nearer ? label[x] : row.label[x];
  }
}

/// Gives each pixel to the nearest patch.
void assign(const RgbdView& view, const cv::Mat& by_depth, const std::vector<Segment>& segments, int side,
            cv::Mat& labels) {
  const int columns = (view.depth.cols + side - 1 - side / 2) / side;
  const int rows = static_cast<int>(segments.size()) / std::max(1, columns);
  Candidates candidates(view.depth.cols, side, columns, rows);
  std::vector<float> best(static_cast<std::size_t>(view.depth.cols));
  int gathered = -1;
  for (int y = 0; y < view.depth.rows; ++y) {
    if (const int row = std::min(y / side, rows - 1); row != gathered)
      candidates.gather(segments, gathered = row);
    std::fill(best.begin(), best.end(), std::numeric_limits<float>::max());
    const Row row{view.depth.cols,          static_cast<float>(y),  1.0F / static_cast<float>(side),
                  view.depth.ptr<float>(y), by_depth.ptr<float>(y), best.data(),
                  labels.ptr<int>(y)};
    for (const Candidates::Candidate& candidate : candidates.all()) offer(candidate, row);
    for (int x = 0; x < row.width; ++x) row.label[x] = row.depth[x] > 0 ? row.label[x] : -1;
  }
}

/// Two patches that touch on one surface, and how many pixels of boundary they share: the weight of their
/// agreement.
struct Contact {
  int a = 0, b = 0;
  int boundary = 0;
};

std::vector<Contact> contacts(const RgbdView& view, const cv::Mat& labels) {
  std::vector<std::pair<int, int>> touching;
  const auto look = [&](int a, int b, float za, float zb) {
    if (a < 0 || b < 0 || a == b || !same_surface(za, zb)) return;
    touching.emplace_back(std::min(a, b), std::max(a, b));
  };
  for (int y = 0; y < labels.rows; ++y) {
    const bool last = y + 1 == labels.rows;
    const auto *label = labels.ptr<int>(y), *label_below = last ? label : labels.ptr<int>(y + 1);
    const auto *z = view.depth.ptr<float>(y), *z_below = last ? z : view.depth.ptr<float>(y + 1);
    for (int x = 0; x < labels.cols; ++x) {
      if (x + 1 < labels.cols) look(label[x], label[x + 1], z[x], z[x + 1]);
      look(label[x], label_below[x], z[x], z_below[x]);
    }
  }
  std::sort(touching.begin(), touching.end());
  std::vector<Contact> result;
  for (const auto& [a, b] : touching) {
    if (result.empty() || result.back().a != a || result.back().b != b) result.push_back({a, b, 0});
    ++result.back().boundary;
  }
  return result;
}

}  // namespace

SurfacePatches segment_surfaces(const RgbdView& view, const DepthMotionConfig& config) {
  SurfacePatches patches{cv::Mat(view.depth.size(), CV_32SC1, cv::Scalar(-1)),
                         seeds(view, config.segment_px)};
  auto& [labels, segments] = patches;
  const cv::Mat by_depth = 1.0F / (kDepthScale * view.depth);  // 0 where there is none
  for (int round = 0; round < kRounds; ++round) {
    assign(view, by_depth, segments, config.segment_px, labels);
    std::vector<Sum> sums(segments.size());
    for (int y = 0; y < labels.rows; ++y) {
      const auto* label = labels.ptr<int>(y);
      const auto* depth = view.depth.ptr<float>(y);
      for (int x = 0; x < labels.cols; ++x) {
        if (label[x] < 0) continue;
        Sum& sum = sums[static_cast<std::size_t>(label[x])];
        sum.x += x, sum.y += y, sum.z += depth[x], ++sum.count;
      }
    }
    for (std::size_t i = 0; i < segments.size(); ++i) {
      segments[i].pixels = sums[i].count;
      if (sums[i].count == 0) continue;
      const double n = sums[i].count;
      segments[i].centre = {static_cast<float>(sums[i].x / n), static_cast<float>(sums[i].y / n)};
      segments[i].depth = static_cast<float>(sums[i].z / n);
    }
  }
  return patches;
}

void judge_segments(const RgbdView& view, const cv::Mat& log_odds, const cv::Mat& labels,
                    const DepthMotionConfig& config, std::vector<Segment>& segments) {
  for (int y = 0; y < labels.rows; ++y) {
    const auto* label = labels.ptr<int>(y);
    const auto* odds = log_odds.ptr<float>(y);
    for (int x = 0; x < labels.cols; ++x)
      if (label[x] >= 0) segments[static_cast<std::size_t>(label[x])].evidence += odds[x];
  }
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
  for (const Contact& contact : contacts(view, labels)) {
    const auto a = static_cast<std::size_t>(contact.a), b = static_cast<std::size_t>(contact.b);
    const float weight = static_cast<float>(config.smoothing) * static_cast<float>(contact.boundary) /
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
