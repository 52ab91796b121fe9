#include "core/motion/stillpoint/superpixels.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <opencv2/core/hal/intrin.hpp>
#include <span>

#include "core/avx2.hpp"

namespace stillpoint {
namespace {

constexpr int kRounds = 3;            // SLIC has settled by then
constexpr float kDepthScale = 0.05F;  // share of the distance that weighs as much as a superpixel's side
constexpr float kNearest = 1e-3F;     // m: nothing is divided by 0 where there is no depth
constexpr int kRelaxations = 15;      // rounds: in each, evidence goes one superpixel farther
constexpr float kMostSay = 2.5F;      // log-odds: the surest superpixel does not outvote its neighbours

struct Sum {
  double x = 0, y = 0, z = 0;
  int count = 0;
};

/// How many superpixels lie along so many pixels: one at the least.
int patches_along(int length, int side) { return std::max(1, (length + side - 1 - side / 2) / side); }

std::vector<Superpixel> seeds(const RgbdView& view, int side) {
  std::vector<Superpixel> superpixels;
  for (int row = 0; row < patches_along(view.depth.rows, side); ++row)
    for (int column = 0; column < patches_along(view.depth.cols, side); ++column) {
      const int x = std::min(side / 2 + column * side, view.depth.cols - 1),
                y = std::min(side / 2 + row * side, view.depth.rows - 1);
      Superpixel superpixel;
      superpixel.centre = {static_cast<float>(x), static_cast<float>(y)};
      superpixel.depth = view.depth.at<float>(y, x);
      superpixels.push_back(superpixel);
    }
  return superpixels;
}

constexpr int kLanes = cv::v_float32x4::nlanes, kWideLanes = 8;  // floats of a register

/// The nine superpixels that may have the pixels of one row of cells: a superpixel never wanders far from its
/// seed. What a superpixel's distance needs stands at every column, so that several pixels are compared at
/// once.
struct Candidate {
  std::vector<float> x, y, z;
  std::vector<int> label;
};

class Candidates {
 public:
  Candidates(int width, int side, int columns, int rows) : side_(side), columns_(columns), rows_(rows) {
    const auto n = static_cast<std::size_t>(width);
    for (auto& row : of_row_)
      for (Candidate& c : row)
        c = {std::vector<float>(n), std::vector<float>(n), std::vector<float>(n), std::vector<int>(n)};
  }

  /// For the pixels of a row of cells; rows one after the other, from 0 on.
  void gather(const std::vector<Superpixel>& superpixels, int row) {
    if (row == 0) fill(superpixels, -1), fill(superpixels, 0);
    fill(superpixels, row + 1);
    for (std::size_t k = 0; k < all_.size(); ++k)
      all_[k] = &of_row_[place_of(row - 1 + static_cast<int>(k) / 3)][k % 3];
  }

  /// Row by row, from the left.
  [[nodiscard]] const std::array<const Candidate*, 9>& all() const { return all_; }

 private:
  static std::size_t place_of(int row) { return static_cast<std::size_t>(row + 3) % 3; }

  /// The superpixels of one row, as those left of a pixel, at its own column, and right of it.
  void fill(const std::vector<Superpixel>& superpixels, int row) {
    constexpr float kNowhere = 1e9F;  // px: beyond every image, so that it is nobody's nearest
    const Superpixel nobody{.centre = {kNowhere, kNowhere}};
    int beside = -1;
    for (Candidate& candidate : of_row_[place_of(row)]) {
      const int width = static_cast<int>(candidate.x.size());
      for (int column = 0; column < columns_; ++column) {
        const int c = column + beside;
        const bool exists = row >= 0 && row < rows_ && c >= 0 && c < columns_;
        const Superpixel& superpixel =
            exists ? superpixels[static_cast<std::size_t>(row * columns_ + c)] : nobody;
        const int begin = column * side_, end = column + 1 < columns_ ? begin + side_ : width;
        std::fill(candidate.x.begin() + begin, candidate.x.begin() + end, superpixel.centre.x);
        std::fill(candidate.y.begin() + begin, candidate.y.begin() + end, superpixel.centre.y);
        std::fill(candidate.z.begin() + begin, candidate.z.begin() + end, superpixel.depth);
        std::fill(candidate.label.begin() + begin, candidate.label.begin() + end, row * columns_ + c);
      }
      ++beside;
    }
  }

  int side_, columns_, rows_;
  std::array<std::array<Candidate, 3>, 3> of_row_;  // of the three rows about a pixel, by row modulo 3
  std::array<const Candidate*, 9> all_{};
};

/// A row's pixels, as many as fill the lanes, and the nearest superpixel found for each so far.
struct Row {
  std::vector<float> x, depth, by_depth;  // by_depth, 1 / m: what a difference in depth counts
  std::vector<float> distance;
  std::vector<int> label;
};

/// Weighs a superpixel against the nearest so far: by place in units of the superpixel's side, by depth in
/// shares of the distance.
void offer(const Candidate& candidate, float y, float side, Row& row) {
  const cv::v_float32x4 no_depth =
      cv::v_setall_f32(2.0F);  // how far in depth a superpixel lies that has none yet
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

/// The nearest superpixel of each pixel of a row, by offer() of all candidates; -1 where there is no depth.
void find_nearest(const std::array<const Candidate*, 9>& candidates, float y, float side, Row& row) {
  for (std::size_t x = 0; x < row.depth.size(); ++x)
    row.by_depth[x] = 1.0F / (kDepthScale * std::max(kNearest, row.depth[x]));
  std::fill(row.distance.begin(), row.distance.end(), std::numeric_limits<float>::max());
  for (const Candidate* candidate : candidates) offer(*candidate, y, side, row);
  for (std::size_t x = 0; x < row.depth.size(); ++x)
    if (!(row.depth[x] > 0)) row.label[x] = -1;
}

#if defined(__x86_64__)
/// The same, eight pixels at a time and each with all its candidates.
STILLPOINT_AVX2 void find_nearest_by_avx2(const std::array<const Candidate*, 9>& candidates, float y,
                                          float side, Row& row) {
  const __m256 no_depth = _mm256_set1_ps(2.0F), zero = _mm256_setzero_ps(), down = _mm256_set1_ps(y),
               by_side = _mm256_set1_ps(1.0F / side);
  for (std::size_t x = 0; x < row.x.size(); x += kWideLanes) {
    const __m256 at = _mm256_loadu_ps(&row.x[x]), depth = _mm256_loadu_ps(&row.depth[x]);
    const __m256 by_depth = _mm256_div_ps(
        _mm256_set1_ps(1.0F),
        _mm256_mul_ps(_mm256_set1_ps(kDepthScale), _mm256_max_ps(depth, _mm256_set1_ps(kNearest))));
    __m256 best = _mm256_set1_ps(std::numeric_limits<float>::max());
    __m256i* label = reinterpret_cast<__m256i*>(&row.label[x]);
    __m256 best_label = _mm256_castsi256_ps(_mm256_loadu_si256(label));
    for (const Candidate* candidate : candidates) {
      const __m256 z = _mm256_loadu_ps(&candidate->z[x]);
      const __m256 dx = _mm256_mul_ps(_mm256_sub_ps(at, _mm256_loadu_ps(&candidate->x[x])), by_side);
      const __m256 dy = _mm256_mul_ps(_mm256_sub_ps(down, _mm256_loadu_ps(&candidate->y[x])), by_side);
      const __m256 dz = _mm256_blendv_ps(no_depth, _mm256_mul_ps(_mm256_sub_ps(depth, z), by_depth),
                                         _mm256_cmp_ps(z, zero, _CMP_GT_OQ));
      const __m256 d =
          _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy)), _mm256_mul_ps(dz, dz));
      const __m256 nearer = _mm256_cmp_ps(d, best, _CMP_LT_OQ);
      best = _mm256_blendv_ps(best, d, nearer);
      best_label = _mm256_blendv_ps(
          best_label, _mm256_loadu_ps(reinterpret_cast<const float*>(&candidate->label[x])), nearer);
    }
    const __m256 measured = _mm256_cmp_ps(depth, zero, _CMP_GT_OQ);
    _mm256_storeu_si256(label, _mm256_castps_si256(_mm256_blendv_ps(
                                   _mm256_castsi256_ps(_mm256_set1_epi32(-1)), best_label, measured)));
  }
}
#else
void find_nearest_by_avx2(const std::array<const Candidate*, 9>&, float, float, Row&) {}
#endif

/// What giving pixels to superpixels is done in, round after round.
struct Workspace {
  Workspace(int width, std::size_t superpixels, int side)
      : columns(patches_along(width, side)),
        rows(static_cast<int>(superpixels) / columns),
        padded(static_cast<std::size_t>((width + kWideLanes - 1) / kWideLanes * kWideLanes)),
        candidates(static_cast<int>(padded), side, columns, rows),
        row{std::vector<float>(padded), std::vector<float>(padded), std::vector<float>(padded),
            std::vector<float>(padded), std::vector<int>(padded)},
        sums(superpixels) {
    std::iota(row.x.begin(), row.x.end(), 0.0F);
  }

  int columns, rows;   // of superpixels
  std::size_t padded;  // px
  Candidates candidates;
  Row row;
  std::vector<Sum> sums;
};

/// Gives each pixel to the nearest superpixel.
void assign(const RgbdView& view, const std::vector<Superpixel>& superpixels, int side, bool wide,
            Workspace& work, cv::Mat& labels) {
  const int rows = work.rows, width = view.depth.cols;
  Candidates& candidates = work.candidates;
  Row& row = work.row;
  int gathered = -1;
  for (int y = 0; y < view.depth.rows; ++y) {
    if (const int r = std::min(y / side, rows - 1); r != gathered)
      candidates.gather(superpixels, gathered = r);
    const auto* depth = view.depth.ptr<float>(y);
    std::copy(depth, depth + width, row.depth.begin());
    (wide ? find_nearest_by_avx2 : find_nearest)(candidates.all(), static_cast<float>(y),
                                                 static_cast<float>(side), row);
    std::copy_n(row.label.begin(), width, labels.ptr<int>(y));
  }
}

/// Adds the pixels of row y to their superpixels' sums; those side by side in one go, as sums of whole
/// numbers are exact. Depths are added one by one.
void add_row(const int* label, const float* depth, int width, int y, std::vector<Sum>& sums) {
  for (int x = 0; x < width;) {
    const int of = label[x], first = x;
    if (of < 0) {
      ++x;
      continue;
    }
    Sum& sum = sums[static_cast<std::size_t>(of)];
    double z = sum.z;
    for (; x < width && label[x] == of; ++x) z += depth[x];
    const int count = x - first;
    sum.x += 0.5 * (first + x - 1) * count, sum.y += static_cast<double>(y) * count;
    sum.z = z, sum.count += count;
  }
}

/// Who touches whom, superpixel after superpixel in one list.
class Neighbours {
 public:
  struct Neighbour {
    std::size_t superpixel;
    float weight;
  };

  Neighbours(const std::vector<AdjacencyEdge>& adjacency, std::size_t superpixels,
             const StillpointConfig& config)
      : start_(superpixels + 1, 0), all_(2 * adjacency.size()) {
    for (const AdjacencyEdge& edge : adjacency)
      ++start_[static_cast<std::size_t>(edge.a) + 1], ++start_[static_cast<std::size_t>(edge.b) + 1];
    for (std::size_t s = 1; s < start_.size(); ++s) start_[s] += start_[s - 1];
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (const AdjacencyEdge& edge : adjacency) {
      const auto a = static_cast<std::size_t>(edge.a), b = static_cast<std::size_t>(edge.b);
      const float weight = static_cast<float>(config.smoothing) * static_cast<float>(edge.boundary) /
                           static_cast<float>(config.superpixel_px);
      all_[next[a]++] = {b, weight};
      all_[next[b]++] = {a, weight};
    }
  }

  [[nodiscard]] std::span<const Neighbour> of(std::size_t superpixel) const {
    return {all_.data() + start_[superpixel], start_[superpixel + 1] - start_[superpixel]};
  }

 private:
  std::vector<std::size_t> start_;  // of each superpixel's part of all_
  std::vector<Neighbour> all_;
};

/// Counts who touches whom. Superpixels lie in a grid of `columns`; a pixel's superpixel is at most one cell
/// off its own, and neighbours' cells are at most one apart: superpixels that touch lie within three cells.
std::vector<AdjacencyEdge> find_adjacency(const RgbdView& view, const cv::Mat& labels,
                                          std::size_t superpixels, int columns) {
  // Cells to a side and below; places of a superpixel's neighbours.
  constexpr int kFar = 3, kWide = 2 * kFar + 1, kPlaces = (kFar + 1) * kWide;
  std::vector<int> counts(superpixels * kPlaces, 0);
  std::vector<int> cell(superpixels);  // so that the difference of two is a place, but for kFar
  for (int i = 0; i < static_cast<int>(superpixels); ++i)
    cell[static_cast<std::size_t>(i)] = i / columns * kWide + i % columns;
  const auto look = [&](int a, int b, float za, float zb) {
    if (a == b || a < 0 || b < 0 || !same_surface(za, zb)) return;
    const int first = std::min(a, b), second = std::max(a, b);
    const int place = cell[static_cast<std::size_t>(second)] - cell[static_cast<std::size_t>(first)] + kFar;
    ++counts[static_cast<std::size_t>(first * kPlaces + place)];
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
  std::vector<AdjacencyEdge> result;
  for (int a = 0; a < static_cast<int>(superpixels); ++a)
    for (int place = 0; place < kPlaces; ++place)
      if (const int count = counts[static_cast<std::size_t>(a * kPlaces + place)]; count > 0)
        result.push_back({a, a + place / kWide * columns + place % kWide - kFar, count});
  return result;
}

}  // namespace

Superpixels make_superpixels(const RgbdView& view, const StillpointConfig& config, bool wide) {
  Superpixels made{
      cv::Mat(view.depth.size(), CV_32SC1, cv::Scalar(-1)), seeds(view, config.superpixel_px), {}};
  auto& [labels, superpixels, adjacency] = made;
  Workspace work(view.depth.cols, superpixels.size(), config.superpixel_px);
  std::vector<Sum>& sums = work.sums;
  for (int round = 0; round < kRounds; ++round) {
    assign(view, superpixels, config.superpixel_px, wide, work, labels);
    std::fill(sums.begin(), sums.end(), Sum{});
    for (int y = 0; y < labels.rows; ++y)
      add_row(labels.ptr<int>(y), view.depth.ptr<float>(y), labels.cols, y, sums);
    for (std::size_t i = 0; i < superpixels.size(); ++i) {
      superpixels[i].pixels = sums[i].count;
      if (sums[i].count == 0) continue;
      const double n = sums[i].count;
      superpixels[i].centre = {static_cast<float>(sums[i].x / n), static_cast<float>(sums[i].y / n)};
      superpixels[i].depth = static_cast<float>(sums[i].z / n);
    }
  }
  adjacency = find_adjacency(view, labels, superpixels.size(), work.columns);
  return made;
}

void judge_superpixels(const cv::Mat& log_odds, const cv::Mat& labels,
                       const std::vector<AdjacencyEdge>& adjacency, const StillpointConfig& config,
                       std::vector<Superpixel>& superpixels) {
  for (int y = 0; y < labels.rows; ++y) {
    const auto* label = labels.ptr<int>(y);
    const auto* odds = log_odds.ptr<float>(y);
    for (int x = 0; x < labels.cols;) {
      const int of = label[x];
      float sum = of >= 0 ? superpixels[static_cast<std::size_t>(of)].evidence : 0.0F;
      for (; x < labels.cols && label[x] == of; ++x) sum += odds[x];
      if (of >= 0) superpixels[static_cast<std::size_t>(of)].evidence = sum;
    }
  }
  for (Superpixel& superpixel : superpixels) {
    if (superpixel.pixels > 0) superpixel.evidence /= static_cast<float>(superpixel.pixels);
    superpixel.evidence = std::clamp(superpixel.evidence, -kMostSay, kMostSay);
    superpixel.log_odds = superpixel.evidence;
  }

  const Neighbours neighbours(adjacency, superpixels.size(), config);
  for (int i = 0; i < kRelaxations; ++i)
    for (std::size_t s = 0; s < superpixels.size(); ++s) {
      float sum = superpixels[s].evidence, weights = 1.0F;
      for (const Neighbours::Neighbour& n : neighbours.of(s)) {
        sum += n.weight * superpixels[n.superpixel].log_odds;
        weights += n.weight;
      }
      superpixels[s].log_odds = sum / weights;
    }
  for (Superpixel& superpixel : superpixels)
    superpixel.moving =
        superpixel.pixels > 0 && superpixel.log_odds > static_cast<float>(config.moving_log_odds);
}

}  // namespace stillpoint
