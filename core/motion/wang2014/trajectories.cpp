#include "core/motion/wang2014/trajectories.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/pixel_conventions.hpp"

namespace stillpoint {
namespace {

TrajectoryPoint seen_at(const cv::Point2f& small, const TrajectoryFrame& frame) {
  return {small, frame.rays.at(small.x, small.y), surface_depth(frame.view.depth, small.x, small.y)};
}

}  // namespace

cv::Vec2f flow_between(const cv::Mat& flow, const cv::Point2f& at) {
  const int left = std::clamp(static_cast<int>(at.x), 0, flow.cols - 1),
            top = std::clamp(static_cast<int>(at.y), 0, flow.rows - 1);
  const int right = std::min(left + 1, flow.cols - 1), bottom = std::min(top + 1, flow.rows - 1);
  const float a = at.x - static_cast<float>(left), b = at.y - static_cast<float>(top);
  const auto *upper = flow.ptr<cv::Vec2f>(top), *lower = flow.ptr<cv::Vec2f>(bottom);
  return (upper[left] * (1.0F - a) + upper[right] * a) * (1.0F - b) +
         (lower[left] * (1.0F - a) + lower[right] * a) * b;
}

TrajectorySet advanced(const TrajectorySet& before, const FlowPair* flow, const TrajectoryFrame& here,
                       const Wang2014Config& config) {
  TrajectorySet set;
  const cv::Size size = here.gray.size();
  const auto longest = static_cast<std::size_t>(config.window_frames) + 1;
  const auto cell = static_cast<float>(config.grid_px) / static_cast<float>(kFlowFactor);
  const int columns = std::max(1, static_cast<int>(static_cast<float>(size.width) / cell)),
            rows = std::max(1, static_cast<int>(static_cast<float>(size.height) / cell));
  std::vector<std::uint8_t> taken(static_cast<std::size_t>(columns * rows), 0);
  if (flow != nullptr) {
    set.timestamps = before.timestamps;
    const float right = static_cast<float>(size.width - 1), bottom = static_cast<float>(size.height - 1);
    const auto limit = static_cast<float>(config.forward_backward_px / kFlowFactor),
               share = static_cast<float>(config.forward_backward_share);
    for (const PointTrajectory& old : before.all) {
      const cv::Point2f from = old.back().small;
      const cv::Vec2f forward = flow_between(flow->here_from_last, from);
      const cv::Point2f there(from.x + forward[0], from.y + forward[1]);
      // Also false for NaN.
      if (!(there.x >= 0.0F && there.y >= 0.0F && there.x <= right && there.y <= bottom)) continue;
      const cv::Vec2f miss = forward + flow_between(flow->last_from_here, there);
      if (!(std::sqrt(miss.dot(miss)) <= limit + share * std::sqrt(forward.dot(forward)))) continue;
      const int column = std::min(columns - 1, static_cast<int>(there.x / cell)),
                row = std::min(rows - 1, static_cast<int>(there.y / cell));
      std::uint8_t& here_already = taken[static_cast<std::size_t>(row * columns + column)];
      // The first, which is the oldest, stands for all that run together.
      if (here_already != 0) continue;
      here_already = 1;
      const std::size_t dropped = old.size() < longest ? 0 : old.size() + 1 - longest;
      PointTrajectory longer(old.begin() + static_cast<std::ptrdiff_t>(dropped), old.end());
      longer.push_back(seen_at(there, here));
      set.all.push_back(std::move(longer));
    }
  }
  set.timestamps.push_back(here.timestamp);
  if (set.timestamps.size() > longest) set.timestamps.erase(set.timestamps.begin());
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      if (taken[static_cast<std::size_t>(row * columns + column)] == 0)
        set.all.push_back({seen_at(
            upsampled(cv::Point2f(static_cast<float>(column), static_cast<float>(row)), cell), here)});
  return set;
}

std::vector<int> clustered_trajectories(const TrajectorySet& set, const Wang2014Config& config) {
  std::vector<int> fit;
  for (std::size_t i = 0; i < set.all.size(); ++i) {
    const PointTrajectory& one = set.all[i];
    const auto measured =
        std::count_if(one.begin(), one.end(), [](const TrajectoryPoint& point) { return point.measured(); });
    if (measured >= config.least_frames && one.back().measured() &&
        static_cast<double>(one.back().z) <= config.most_depth_m)
      fit.push_back(static_cast<int>(i));
  }
  const auto most = static_cast<std::size_t>(config.most_trajectories);
  if (fit.size() <= most) return fit;
  // By place, row by row, so that an even choice is even in the image.
  const auto row_of = [&](int i) {
    return static_cast<int>(set.all[static_cast<std::size_t>(i)].back().small.y) / 8;
  };
  std::stable_sort(fit.begin(), fit.end(), [&](int a, int b) {
    if (row_of(a) != row_of(b)) return row_of(a) < row_of(b);
    return set.all[static_cast<std::size_t>(a)].back().small.x <
           set.all[static_cast<std::size_t>(b)].back().small.x;
  });
  std::vector<int> chosen;
  for (std::size_t k = 0; k < most; ++k) chosen.push_back(fit[k * fit.size() / most]);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace stillpoint
