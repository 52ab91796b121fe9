#include "core/motion/paper/corners.hpp"

#include <algorithm>
#include <cmath>

#include "core/motion/paper/corner_candidates.hpp"

namespace stillpoint {
namespace {

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
  Neighbourhood chosen(gradients.size(), distance_px);
  for (const cv::Point& at : corner_candidates(gradients, quality)) {
    if (!chosen.is_free(at)) continue;
    chosen.take(at);
    corners.emplace_back(at);
    if (corners.size() == static_cast<std::size_t>(max_corners)) break;
  }
  return corners;
}

}  // namespace stillpoint
