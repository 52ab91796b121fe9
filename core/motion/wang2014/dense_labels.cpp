#include "core/motion/wang2014/dense_labels.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/geometry/pixel_conventions.hpp"
#include "core/motion/stillpoint/superpixels.hpp"

namespace stillpoint {
namespace {

constexpr float kFarthest = 36.0F;  // squared distance beyond which a trajectory says nothing

/// What a superpixel, or a trajectory, is compared by.
struct Look {
  cv::Point2f at;  // small px
  float gray = 0.0F, depth = 0.0F;
  int pixels = 0;
};

class Comparison {
 public:
  explicit Comparison(const Wang2014Config& config)
      : by_place_(static_cast<float>(kFlowFactor / config.place_scale_px)),
        by_gray_(static_cast<float>(1.0 / config.colour_scale)),
        by_depth_(static_cast<float>(1.0 / config.depth_scale_m)) {}

  [[nodiscard]] float operator()(const Look& a, const Look& b) const {
    const cv::Point2f apart = (a.at - b.at) * by_place_;
    const float gray = (a.gray - b.gray) * by_gray_;
    const float depth = a.depth > 0.0F && b.depth > 0.0F ? (a.depth - b.depth) * by_depth_ : 0.0F;
    return apart.dot(apart) + gray * gray + depth * depth;
  }

 private:
  float by_place_, by_gray_, by_depth_;
};

/// The label of the majority of the three nearest; of three unlike ones the nearest's; -1 = none.
int voted(const Look& look, const std::vector<Look>& trajectories, std::span<const int> label,
          const Comparison& compared) {
  std::array<std::pair<float, int>, 3> nearest;
  nearest.fill({kFarthest, -1});
  for (std::size_t i = 0; i < trajectories.size(); ++i) {
    const std::pair<float, int> candidate{compared(look, trajectories[i]), label[i]};
    if (candidate.first >= nearest[2].first) continue;
    nearest[2] = candidate;
    if (nearest[2].first < nearest[1].first) std::swap(nearest[1], nearest[2]);
    if (nearest[1].first < nearest[0].first) std::swap(nearest[0], nearest[1]);
  }
  return nearest[1].second >= 0 && nearest[1].second == nearest[2].second ? nearest[1].second
                                                                          : nearest[0].second;
}

}  // namespace

cv::Mat dense_labels(const TrajectoryFrame& here, const TrajectorySet& set, std::span<const int> chosen,
                     std::span<const int> label, const Wang2014Config& config) {
  StillpointConfig sizes;
  sizes.superpixel_px = config.superpixel_px;
  const Superpixels superpixels = make_superpixels(here.view, sizes);
  cv::Mat places = superpixels.labels.clone();
  const int surfaces = static_cast<int>(superpixels.all.size());
  const int columns = (places.cols + config.superpixel_px - 1) / config.superpixel_px,
            rows = (places.rows + config.superpixel_px - 1) / config.superpixel_px;
  std::vector<Look> looks(static_cast<std::size_t>(surfaces + columns * rows));
  for (int y = 0; y < places.rows; ++y) {
    auto* place = places.ptr<int>(y);
    const auto *gray = here.view.gray.ptr<float>(y), *depth = here.view.depth.ptr<float>(y);
    for (int x = 0; x < places.cols; ++x) {
      if (place[x] < 0) place[x] = surfaces + y / config.superpixel_px * columns + x / config.superpixel_px;
      Look& look = looks[static_cast<std::size_t>(place[x])];
      look.at += cv::Point2f(static_cast<float>(x), static_cast<float>(y));
      look.gray += gray[x];
      look.depth += depth[x];
      ++look.pixels;
    }
  }
  std::vector<Look> trajectories;
  for (const int i : chosen) {
    const TrajectoryPoint& point = set.all[static_cast<std::size_t>(i)].back();
    const int x = std::clamp(cvRound(point.small.x), 0, places.cols - 1),
              y = std::clamp(cvRound(point.small.y), 0, places.rows - 1);
    trajectories.push_back({point.small, here.view.gray.at<float>(y, x), point.z, 1});
  }
  const Comparison compared(config);
  std::vector<std::uint8_t> value(looks.size(), 0);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    Look look = looks[i];
    if (look.pixels == 0) continue;
    const float share = 1.0F / static_cast<float>(look.pixels);
    look.at *= share, look.gray *= share, look.depth *= share;
    value[i] = static_cast<std::uint8_t>(voted(look, trajectories, label, compared) + 1);
  }
  cv::Mat labels(places.size(), CV_8UC1);
  for (int y = 0; y < places.rows; ++y)
    for (int x = 0; x < places.cols; ++x)
      labels.at<std::uint8_t>(y, x) = value[static_cast<std::size_t>(places.at<int>(y, x))];
  return labels;
}

std::vector<int> label_areas(const cv::Mat& labels, int count) {
  std::vector<int> areas(static_cast<std::size_t>(count), 0);
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x)
      if (const int label = labels.at<std::uint8_t>(y, x) - 1; label >= 0 && label < count)
        ++areas[static_cast<std::size_t>(label)];
  return areas;
}

cv::Mat holes_filled(const cv::Mat& mask) {
  cv::Mat regions, figures, middles;
  const int count = cv::connectedComponentsWithStats(mask == 0, regions, figures, middles, 4, CV_32S);
  const int most = static_cast<int>(mask.total() / 100);
  cv::Mat filled = mask.clone();
  for (int r = 1; r < count; ++r) {
    const int left = figures.at<int>(r, cv::CC_STAT_LEFT), top = figures.at<int>(r, cv::CC_STAT_TOP),
              right = left + figures.at<int>(r, cv::CC_STAT_WIDTH),
              bottom = top + figures.at<int>(r, cv::CC_STAT_HEIGHT);
    if (left == 0 || top == 0 || right == mask.cols || bottom == mask.rows ||
        figures.at<int>(r, cv::CC_STAT_AREA) >= most)
      continue;
    filled.setTo(255, regions == r);
  }
  return filled;
}

cv::Mat carried(const cv::Mat& image, const cv::Mat& last_from_here) {
  cv::Mat here = cv::Mat::zeros(image.size(), CV_8UC1);
  const float first = to_pixel(RasterCoordinate(0.0F));  // the left and the upper side
  const float right = to_pixel(RasterCoordinate(static_cast<float>(here.cols))),
              bottom = to_pixel(RasterCoordinate(static_cast<float>(here.rows)));
  for (int y = 0; y < here.rows; ++y) {
    const auto* back = last_from_here.ptr<cv::Vec2f>(y);
    auto* out = here.ptr<std::uint8_t>(y);
    for (int x = 0; x < here.cols; ++x) {
      const float there_x = static_cast<float>(x) + back[x][0], there_y = static_cast<float>(y) + back[x][1];
      // Also false for NaN.
      if (!(there_x > first && there_y > first && there_x < right && there_y < bottom)) continue;
      out[x] = image.at<std::uint8_t>(std::clamp(cvRound(there_y), 0, here.rows - 1),
                                      std::clamp(cvRound(there_x), 0, here.cols - 1));
    }
  }
  return here;
}

}  // namespace stillpoint
