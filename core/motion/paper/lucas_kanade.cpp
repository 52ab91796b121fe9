#include "core/motion/paper/lucas_kanade.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <opencv2/video/tracking.hpp>
#include <utility>

#include "core/motion/paper/flow_window.hpp"

namespace stillpoint {
namespace {

constexpr float kLeastEigenvalue = 1e-4F;  // OpenCV's own: below it a window has no corner

FollowedPoints ask_opencv(const std::vector<cv::Mat>& source, const std::vector<cv::Mat>& destination,
                          const std::vector<cv::Point2f>& points, const FlowSettings& settings) {
  FollowedPoints followed;
  const cv::TermCriteria stop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, settings.max_steps,
                              settings.least_step_px);
  // Without OPTFLOW_LK_GET_MIN_EIGENVALS the residuals are mean absolute differences.
  cv::calcOpticalFlowPyrLK(source, destination, points, followed.to, followed.found, followed.residuals,
                           {settings.window_px, settings.window_px}, settings.levels, stop, 0,
                           kLeastEigenvalue);
  return followed;
}

#if defined(__x86_64__)

// From a window's first pixel to its middle, px.
const cv::Point2f kHalf((kWindow - 1) * 0.5F, (kWindow - 1) * 0.5F);

/// Follows one point from level to level, the coarsest first.
class PointFollower {
 public:
  /// @param known,to_fill a number a level of each point, as in KnownSums; or null
  PointFollower(const std::vector<cv::Mat>& source, const std::vector<cv::Mat>& destination,
                const FlowSettings& settings, const GradientSums* known, GradientSums* to_fill)
      : source_(source),
        destination_(destination),
        known_(known),
        to_fill_(to_fill),
        steps_(settings.max_steps),
        least_step_squared_(settings.least_step_px * settings.least_step_px) {}

  /// @param index the point's @param to where it goes @param residual grey levels @return false when it is
  /// lost
  bool follow(std::size_t index, const cv::Point2f& point, int levels, cv::Point2f& to, float& residual) {
    for (int level = levels; level >= 0; --level) {
      const cv::Point2f from = point * static_cast<float>(1.0 / (1 << level));
      to = level == levels ? from : to * 2.0F;
      const std::size_t window =
          index * static_cast<std::size_t>(levels + 1) + static_cast<std::size_t>(level);
      const bool there = settle(static_cast<std::size_t>(2 * level), window, from - kHalf, to);
      if (level == 0 && !there) return false;
    }
    const WindowPlace place(to - kHalf);
    if (!place.touches(destination_[0])) return false;
    residual = mean_difference(window_, destination_[0], place);
    return true;
  }

 private:
  GradientSums sums_of(std::size_t window) {
    if (known_ != nullptr) return known_[window];
    const GradientSums sums = sum_gradients(window_);
    if (to_fill_ != nullptr) to_fill_[window] = sums;
    return sums;
  }

  /// Moves `to` until it no longer moves. @param first the window's first pixel in the source
  /// @return false when there is nothing to go by, or it left the image
  bool settle(std::size_t level, std::size_t window, const cv::Point2f& first, cv::Point2f& to) {
    const WindowPlace from(first);
    if (!from.touches(source_[level + 1])) return false;
    fill_window(source_[level], source_[level + 1], from, window_);
    const auto [a11, a12, a22, rest_most] = sums_of(window);
    const float determinant = a11 * a22 - a12 * a12;
    const float least = (a22 + a11 - std::sqrt((a11 - a22) * (a11 - a22) + 4.0F * a12 * a12)) /
                        static_cast<float>(2 * kWindow * kWindow);
    if (least < kLeastEigenvalue || determinant < FLT_EPSILON) return false;
    const float inverse = 1.0F / determinant;
    cv::Point2f at = to - kHalf, last;
    for (int step = 0; step < steps_; ++step) {
      const WindowPlace place(at);
      if (!place.touches(destination_[level])) return false;
      const cv::Point2f b = mismatch(window_, rest_most, destination_[level], place);
      const cv::Point2f delta((a12 * b.y - a22 * b.x) * inverse, (a12 * b.x - a11 * b.y) * inverse);
      at += delta;
      to = at + kHalf;
      if (delta.ddot(delta) <= least_step_squared_) break;
      if (step > 0 && std::abs(delta.x + last.x) < 0.01 && std::abs(delta.y + last.y) < 0.01) {
        to -= delta * 0.5F;  // to and fro
        break;
      }
      last = delta;
    }
    return true;
  }

  const std::vector<cv::Mat>&source_, &destination_;
  const GradientSums* known_;
  GradientSums* to_fill_;
  int steps_;
  double least_step_squared_;
  Window window_;
};

bool is_our_case(const FlowSettings& settings) {
  static const bool has_avx2 = cv::checkHardwareSupport(CV_CPU_AVX2);
  return has_avx2 && settings.window_px == kWindow;
}

FollowedPoints follow_by_avx2(const std::vector<cv::Mat>& source, const std::vector<cv::Mat>& destination,
                              const std::vector<cv::Point2f>& points, const FlowSettings& settings,
                              KnownSums* sums) {
  const int levels = std::min({settings.levels, static_cast<int>(source.size()) / 2 - 1,
                               static_cast<int>(destination.size()) / 2 - 1});
  FollowedPoints followed{points, std::vector<unsigned char>(points.size()),
                          std::vector<float>(points.size())};
  const std::vector<GradientSums>* known = sums != nullptr ? sums->all() : nullptr;
  std::vector<GradientSums>* to_fill = sums != nullptr && known == nullptr ? sums->to_fill() : nullptr;
  if (to_fill != nullptr) to_fill->resize(points.size() * static_cast<std::size_t>(levels + 1));
  PointFollower follower(source, destination, settings, known != nullptr ? known->data() : nullptr,
                         to_fill != nullptr ? to_fill->data() : nullptr);
  // From top to bottom: what one point reads is still in the cache when its neighbour does.
  std::vector<std::pair<float, std::size_t>> downwards;
  downwards.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) downwards.emplace_back(points[i].y, i);
  std::sort(downwards.begin(), downwards.end());
  for (const auto& [y, i] : downwards)
    followed.found[i] = follower.follow(i, points[i], levels, followed.to[i], followed.residuals[i]) ? 1 : 0;
  if (to_fill != nullptr) sums->set_filled();
  return followed;
}

#endif

}  // namespace

FollowedPoints follow_points(const std::vector<cv::Mat>& source, const std::vector<cv::Mat>& destination,
                             const std::vector<cv::Point2f>& points, const FlowSettings& settings,
                             [[maybe_unused]] KnownSums* sums) {
#if defined(__x86_64__)
  if (is_our_case(settings)) return follow_by_avx2(source, destination, points, settings, sums);
#endif
  return ask_opencv(source, destination, points, settings);
}

}  // namespace stillpoint
