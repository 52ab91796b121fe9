#include "core/motion/stillpoint/segments.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <opencv2/core/hal/intrin.hpp>
#include <span>

namespace stillpoint {
namespace {

constexpr int kRounds = 3;            // SLIC has settled by then
constexpr float kDepthScale = 0.05F;  // share of the distance that weighs as much as a patch's side
constexpr float kNearest = 1e-3F;     // m
constexpr int kRelaxations = 15;
constexpr float kMostSay = 2.5F;  // log-odds: the surest patch does not outvote its neighbours

struct Sum {
  double x = 0, y = 0, z = 0;
  int count = 0;
};

/// How many patches lie along so many pixels: one at the least.
int patches_along(int length, int side) { return std::max(1, (length + side - 1 - side / 2) / side); }

std::vector<Segment> seeds(const RgbdView& view, int side) {
  std::vector<Segment> segments;
  for (int row = 0; row < patches_along(view.depth.rows, side); ++row)
    for (int column = 0; column < patches_along(view.depth.cols, side); ++column) {
      const int x = std::min(side / 2 + column * side, view.depth.cols - 1),
                y = std::min(side / 2 + row * side, view.depth.rows - 1);
      Segment segment;
      segment.centre = {static_cast<float>(x), static_cast<float>(y)};
      segment.depth = view.depth.at<float>(y, x);
      segments.push_back(segment);
    }
  return segments;
}

constexpr int kLanes = cv::v_float32x4::nlanes;

/// The nine patches that may have the pixels of one row of cells: a patch never wanders far from its seed.
/// What a patch's distance needs stands at every column, so that several pixels are compared at once.
struct Candidate {
  std::vector<float> x, y, z;
  std::vector<int> label;
};

class Candidates {
 public:
  Candidates(int width, int side, int columns, int rows) : side_(side), columns_(columns), rows_(rows) {
    const auto n = static_cast<std::size_t>(width);
    for (Candidate& c : all_)
      c = {std::vector<float>(n), std::vector<float>(n), std::vector<float>(n), std::vector<int>(n)};
  }

  void gather(const std::vector<Segment>& segments, int row) {
    for (std::size_t k = 0; k < all_.size(); ++k) {
      Candidate& candidate = all_[k];
      const int r = row - 1 + static_cast<int>(k) / 3;
      for (std::size_t x = 0; x < candidate.x.size(); ++x) {
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

  [[nodiscard]] const std::array<Candidate, 9>& all() const { return all_; }

 private:
  int side_, columns_, rows_;
  std::array<Candidate, 9> all_;
};

/// A row's pixels, as many as fill the lanes, and the nearest patch found for each so far.
struct Row {
  std::vector<float> x, depth, by_depth;  // by_depth, 1 / m: what a difference in depth counts
  std::vector<float> distance;
  std::vector<int> label;
};

/// Weighs a patch against the nearest so far: by place in units of the patch's side, by depth in shares of
/// the distance.
void offer(const Candidate& candidate, float y, float side, Row& row) {
  const cv::v_float32x4 no_depth = cv::v_setall_f32(2.0F);  // how far in depth a patch lies that has none yet
  const cv::v_float32x4 zero = cv::v_setzero_f32(), down = cv::v_setall_f32(y),
                        by_side = cv::v_setall_f32(1.0F / side);
  for (std::size_t x = 0; x < row.x.size(); x += kLanes) {
    const cv::v_float32x4 z = cv::v_load(&candidate.z[x]);
    const cv::v_float32x4 dx = (cv::v_load(&row.x[x]) - cv::v_load(&candidate.x[x])) * by_side;
    const cv::v_float32x4 dy = (down - cv::v_load(&candidate.y[x])) * by_side;
    const cv::v_float32x4 dz =
        cv::v_select(z > zero, (cv::v_load(&row.depth[x]) - z) * cv::v_load(&row.by_depth[x]), no_depth);
    const cv::v_float32x4 d = dx * dx + dy * dy + dz * dz, best = cv::v_load(&row.distance[x]);
    const cv::v_float32x4 nearer = d < best;
    cv::v_store(&row.distance[x], cv::v_select(nearer, d, best));
    cv::v_store(&row.label[x], cv::v_select(cv::v_reinterpret_as_s32(nearer), cv::v_load(&candidate.label[x]),
                                            cv::v_load(&row.label[x])));
  }
}

/// What giving pixels to patches is done in, round after round.
struct Workspace {
  Workspace(int width, std::size_t segments, int side)
      : columns(patches_along(width, side)),
        rows(static_cast<int>(segments) / columns),
        padded(static_cast<std::size_t>((width + kLanes - 1) / kLanes * kLanes)),
        candidates(static_cast<int>(padded), side, columns, rows),
        row{std::vector<float>(padded), std::vector<float>(padded), std::vector<float>(padded),
            std::vector<float>(padded), std::vector<int>(padded)},
        sums(segments) {
    std::iota(row.x.begin(), row.x.end(), 0.0F);
  }

  int columns, rows;   // of patches
  std::size_t padded;  // px
  Candidates candidates;
  Row row;
  std::vector<Sum> sums;
};

/// Gives each pixel to the nearest patch.
void assign(const RgbdView& view, const std::vector<Segment>& segments, int side, Workspace& work,
            cv::Mat& labels) {
  const int rows = work.rows, width = view.depth.cols;
  const std::size_t n = work.padded;
  Candidates& candidates = work.candidates;
  Row& row = work.row;
  int gathered = -1;
  for (int y = 0; y < view.depth.rows; ++y) {
    if (const int r = std::min(y / side, rows - 1); r != gathered) candidates.gather(segments, gathered = r);
    const auto* depth = view.depth.ptr<float>(y);
    std::copy(depth, depth + width, row.depth.begin());
    for (std::size_t x = 0; x < n; ++x)
      row.by_depth[x] = 1.0F / (kDepthScale * std::max(kNearest, row.depth[x]));
    std::fill(row.distance.begin(), row.distance.end(), std::numeric_limits<float>::max());
    for (const Candidate& candidate : candidates.all())
      offer(candidate, static_cast<float>(y), static_cast<float>(side), row);
    auto* label = labels.ptr<int>(y);
    for (int x = 0; x < width; ++x) label[x] = depth[x] > 0 ? row.label[static_cast<std::size_t>(x)] : -1;
  }
}

/// Who touches whom, patch after patch in one list.
class Neighbours {
 public:
  struct Neighbour {
    std::size_t segment;
    float weight;
  };

  Neighbours(const std::vector<Contact>& contacts, std::size_t segments, const StillpointConfig& config)
      : start_(segments + 1, 0), all_(2 * contacts.size()) {
    for (const Contact& contact : contacts)
      ++start_[static_cast<std::size_t>(contact.a) + 1], ++start_[static_cast<std::size_t>(contact.b) + 1];
    for (std::size_t s = 1; s < start_.size(); ++s) start_[s] += start_[s - 1];
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (const Contact& contact : contacts) {
      const auto a = static_cast<std::size_t>(contact.a), b = static_cast<std::size_t>(contact.b);
      const float weight = static_cast<float>(config.smoothing) * static_cast<float>(contact.boundary) /
                           static_cast<float>(config.segment_px);
      all_[next[a]++] = {b, weight};
      all_[next[b]++] = {a, weight};
    }
  }

  [[nodiscard]] std::span<const Neighbour> of(std::size_t segment) const {
    return {all_.data() + start_[segment], start_[segment + 1] - start_[segment]};
  }

 private:
  std::vector<std::size_t> start_;  // of each patch's part of all_
  std::vector<Neighbour> all_;
};

/// Counts who touches whom. Patches lie in a grid of `columns`; a pixel's patch is at most one cell off its
/// own, and neighbours' cells are at most one apart: patches that touch lie within three cells.
std::vector<Contact> find_contacts(const RgbdView& view, const cv::Mat& labels, std::size_t patches,
                                   int columns) {
  constexpr int kFar = 3, kWide = 2 * kFar + 1, kPlaces = (kFar + 1) * kWide;
  std::vector<int> counts(patches * kPlaces, 0);
  const auto look = [&](int a, int b, float za, float zb) {
    if (a < 0 || b < 0 || a == b || !same_surface(za, zb)) return;
    const int first = std::min(a, b), second = std::max(a, b);
    const int down = second / columns - first / columns, right = second % columns - first % columns;
    ++counts[static_cast<std::size_t>(first * kPlaces + down * kWide + right + kFar)];
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
  std::vector<Contact> result;
  for (int a = 0; a < static_cast<int>(patches); ++a)
    for (int place = 0; place < kPlaces; ++place)
      if (const int count = counts[static_cast<std::size_t>(a * kPlaces + place)]; count > 0)
        result.push_back({a, a + place / kWide * columns + place % kWide - kFar, count});
  return result;
}

}  // namespace

SurfacePatches segment_surfaces(const RgbdView& view, const StillpointConfig& config) {
  SurfacePatches patches{
      cv::Mat(view.depth.size(), CV_32SC1, cv::Scalar(-1)), seeds(view, config.segment_px), {}};
  auto& [labels, segments, contacts] = patches;
  Workspace work(view.depth.cols, segments.size(), config.segment_px);
  std::vector<Sum>& sums = work.sums;
  for (int round = 0; round < kRounds; ++round) {
    assign(view, segments, config.segment_px, work, labels);
    std::fill(sums.begin(), sums.end(), Sum{});
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
  contacts = find_contacts(view, labels, segments.size(), work.columns);
  return patches;
}

void judge_segments(const cv::Mat& log_odds, const cv::Mat& labels, const std::vector<Contact>& contacts,
                    const StillpointConfig& config, std::vector<Segment>& segments) {
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

  const Neighbours neighbours(contacts, segments.size(), config);
  for (int i = 0; i < kRelaxations; ++i)
    for (std::size_t s = 0; s < segments.size(); ++s) {
      float sum = segments[s].evidence, weights = 1.0F;
      for (const Neighbours::Neighbour& n : neighbours.of(s)) {
        sum += n.weight * segments[n.segment].log_odds;
        weights += n.weight;
      }
      segments[s].log_odds = sum / weights;
    }
  for (Segment& segment : segments)
    segment.moving = segment.pixels > 0 && segment.log_odds > static_cast<float>(config.moving_log_odds);
}

}  // namespace stillpoint
