#include "core/motion/paper/corners.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <opencv2/core/hal/intrin.hpp>
#include <tuple>

namespace stillpoint {
namespace {

/// One row of the gradient matrix: dx², dx·dy and dy² of every pixel.
struct GradientRow {
  explicit GradientRow(int width)
      : xx(static_cast<std::size_t>(width)),
        xy(static_cast<std::size_t>(width)),
        yy(static_cast<std::size_t>(width)) {}
  std::vector<float> xx, xy, yy;
};

void fill_row(const short* gradients, int width, GradientRow& row) {
  float* xx = row.xx.data();
  float* xy = row.xy.data();
  float* yy = row.yy.data();
  for (int x = 0; x < width; ++x) {
    const float dx = gradients[2 * x], dy = gradients[2 * x + 1];
    xx[x] = dx * dx;
    xy[x] = dx * dy;
    yy[x] = dy * dy;
  }
}

void sum_rows(const std::array<GradientRow, 3>& rows, int width, GradientRow& sum) {
  const auto add = [width](const float* a, const float* b, const float* c, float* to) {
    for (int x = 0; x < width; ++x) to[x] = a[x] + b[x] + c[x];
  };
  add(rows[0].xx.data(), rows[1].xx.data(), rows[2].xx.data(), sum.xx.data());
  add(rows[0].xy.data(), rows[1].xy.data(), rows[2].xy.data(), sum.xy.data());
  add(rows[0].yy.data(), rows[1].yy.data(), rows[2].yy.data(), sum.yy.data());
}

/// Twice the smaller eigenvalue at every pixel but the outermost, which stay 0.
cv::Mat corner_response(const cv::Mat& gradients) {
  const int width = gradients.cols, height = gradients.rows;
  cv::Mat response = cv::Mat::zeros(gradients.size(), CV_32FC1);
  std::array<GradientRow, 3> rows = {GradientRow(width), GradientRow(width), GradientRow(width)};
  GradientRow sum(width);
  for (int y = 0; y < height; ++y) {
    // Row y takes row y-3's place; the order of the three does not matter but for rounding, which it fixes.
    fill_row(gradients.ptr<short>(y), width, rows[static_cast<std::size_t>(y % 3)]);
    if (y < 2) continue;
    sum_rows(rows, width, sum);
    const float *xx = sum.xx.data(), *xy = sum.xy.data(), *yy = sum.yy.data();
    float* of = response.ptr<float>(y - 1);
    for (int x = 1; x < width - 1; ++x) {
      const float a = xx[x - 1] + xx[x] + xx[x + 1];
      const float b = xy[x - 1] + xy[x] + xy[x + 1];
      const float c = yy[x - 1] + yy[x] + yy[x + 1];
      of[x] = a + c - std::sqrt((a - c) * (a - c) + 4.0F * b * b);
    }
  }
  return response;
}

struct Candidate {
  float response;
  int x, y;
};

/// Which of four pixels of a row from x on are at least `least`, and no less than their neighbours in the
/// row: a bit each.
unsigned maxima_in_row(const float* row, int x, float least) {
  const cv::v_float32x4 here = cv::v_load(row + x);
  return static_cast<unsigned>(cv::v_signmask((here >= cv::v_setall_f32(least)) &
                                              (here >= cv::v_load(row + x - 1)) &
                                              (here >= cv::v_load(row + x + 1))));
}

/// Local maxima of at least `least`, strongest first, then in reading order.
std::vector<Candidate> local_maxima(const cv::Mat& response, float least) {
  constexpr int kLanes = cv::v_float32x4::nlanes;
  std::vector<Candidate> found;
  for (int y = 1; y < response.rows - 1; ++y) {
    const float *above = response.ptr<float>(y - 1), *here = response.ptr<float>(y);
    const float* below = response.ptr<float>(y + 1);
    const auto take_if_highest = [&](int x) {
      const float beside =
          std::max({above[x - 1], above[x], above[x + 1], below[x - 1], below[x], below[x + 1]});
      if (here[x] >= beside) found.push_back({here[x], x, y});
    };
    int x = 1;
    for (; x + kLanes < response.cols; x += kLanes)
      for (unsigned maxima = maxima_in_row(here, x, least); maxima != 0; maxima &= maxima - 1)
        take_if_highest(x + std::countr_zero(maxima));
    for (; x < response.cols - 1; ++x)
      if (here[x] >= least && here[x] >= here[x - 1] && here[x] >= here[x + 1]) take_if_highest(x);
  }
  std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(b.response, a.y, a.x) < std::tie(a.response, b.y, b.x);
  });
  return found;
}

/// Who of the chosen is near: a grid so fine that a cell holds one corner at most.
class Neighbourhood {
 public:
  Neighbourhood(const cv::Size& size, double distance_px)
      : cell_px_(distance_px / std::sqrt(2.0)),
        distance_squared_(distance_px * distance_px),
        columns_(cell(size.width) + 1),
        rows_(cell(size.height) + 1),
        cells_(static_cast<std::size_t>(columns_ * rows_), cv::Point(-1, -1)) {}

  [[nodiscard]] bool is_free(const cv::Point& at) const {
    const int column = cell(at.x), row = cell(at.y);
    for (int r = std::max(0, row - 2); r <= std::min(rows_ - 1, row + 2); ++r)
      for (int c = std::max(0, column - 2); c <= std::min(columns_ - 1, column + 2); ++c) {
        const cv::Point& other = cells_[static_cast<std::size_t>(r * columns_ + c)];
        const cv::Point apart = other - at;
        if (other.x >= 0 && apart.dot(apart) < distance_squared_) return false;
      }
    return true;
  }
  void take(const cv::Point& at) {
    cells_[static_cast<std::size_t>(cell(at.y) * columns_ + cell(at.x))] = at;
  }

 private:
  [[nodiscard]] int cell(int coordinate) const { return static_cast<int>(coordinate / cell_px_); }

  double cell_px_, distance_squared_;
  int columns_, rows_;
  std::vector<cv::Point> cells_;
};

}  // namespace

std::vector<cv::Point2f> find_corners(const cv::Mat& gradients, int max_corners, double quality,
                                      double distance_px) {
  std::vector<cv::Point2f> corners;
  const cv::Mat response = corner_response(gradients);
  double best = 0.0;
  cv::minMaxLoc(response, nullptr, &best);
  if (best <= 0.0) return corners;
  Neighbourhood chosen(gradients.size(), distance_px);
  for (const Candidate& candidate : local_maxima(response, static_cast<float>(quality * best))) {
    const cv::Point at(candidate.x, candidate.y);
    if (!chosen.is_free(at)) continue;
    chosen.take(at);
    corners.emplace_back(at);
    if (corners.size() == static_cast<std::size_t>(max_corners)) break;
  }
  return corners;
}

}  // namespace stillpoint
