#include "core/motion/dai2020/graph_layers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/imgproc.hpp>

namespace stillpoint {
namespace {

constexpr int kDot = 2;  // px about a point that its value is painted over

cv::Mat nothing(const cv::Size& size) {
  return cv::Mat(size, CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
}

}  // namespace

cv::Mat edge_image(const cv::Size& size, std::span<const GraphPoint> points, std::span<const PointPair> edges,
                   std::span<const float> values) {
  cv::Mat image = nothing(size);
  std::vector<std::size_t> order(edges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t i) { return !std::isfinite(values[i]); });
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return std::abs(values[a]) < std::abs(values[b]); });
  for (const std::size_t i : order)
    cv::line(image, points[static_cast<std::size_t>(edges[i][0])].pixel,
             points[static_cast<std::size_t>(edges[i][1])].pixel, cv::Scalar(static_cast<double>(values[i])));
  return image;
}

cv::Mat point_image(const cv::Size& size, std::span<const GraphPoint> points, std::span<const float> values) {
  cv::Mat image = nothing(size);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    const cv::Rect box(cvRound(points[i].pixel.x) - kDot, cvRound(points[i].pixel.y) - kDot, 2 * kDot + 1,
                       2 * kDot + 1);
    if (const cv::Rect inside = box & cv::Rect({0, 0}, size); !inside.empty()) image(inside).setTo(values[i]);
  }
  return image;
}

MarkKind mark_of(PointVerdict verdict) {
  switch (verdict) {
    case PointVerdict::kStatic:
      return MarkKind::kInlier;
    case PointVerdict::kDynamic:
      return MarkKind::kRemoved;
    case PointVerdict::kUndecided:
      return MarkKind::kOutlier;
    case PointVerdict::kUnjudged:
      break;
  }
  return MarkKind::kUnmatched;
}

std::map<MarkKind, std::string> verdict_words() {
  return {{MarkKind::kInlier, "static"},
          {MarkKind::kRemoved, "dynamic"},
          {MarkKind::kOutlier, "undecided"},
          {MarkKind::kUnmatched, "not judged"}};
}

Layer feature_verdicts(const Layer& frame, std::span<const MotionFeature> features,
                       std::span<const PointVerdict> verdicts) {
  std::vector<Mark> marks;
  for (std::size_t i = 0; i < features.size(); ++i)
    marks.push_back({features[i].pixel, std::nullopt, mark_of(verdicts[i])});
  Layer layer = marked("Features", frame, std::move(marks));
  layer.words = verdict_words();
  layer.id = "classes";
  return layer;
}

std::vector<PointVerdict> verdicts_of(std::span<const int> nearest, std::span<const PointVerdict> of_point) {
  std::vector<PointVerdict> verdicts;
  for (const int point : nearest)
    verdicts.push_back(point < 0 ? PointVerdict::kUnjudged : of_point[static_cast<std::size_t>(point)]);
  return verdicts;
}

int feature_near(std::span<const MotionFeature> features, const cv::Point2f& pixel) {
  float least = 4.0F;  // px
  int best = -1;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const cv::Point2f apart = features[i].pixel - pixel;
    if (const float distance = std::hypot(apart.x, apart.y); distance < least)
      least = distance, best = static_cast<int>(i);
  }
  return best;
}

std::string sentence_of(PointVerdict verdict) {
  switch (verdict) {
    case PointVerdict::kStatic:
      return "So it is static.";
    case PointVerdict::kDynamic:
      return "So it is dynamic, and dropped.";
    case PointVerdict::kUndecided:
      return "So it is undecided: kept out of the pose, and not called dynamic.";
    case PointVerdict::kUnjudged:
      break;
  }
  return "So it is not judged, and stays.";
}

}  // namespace stillpoint
