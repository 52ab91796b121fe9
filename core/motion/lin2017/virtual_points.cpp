#include "core/motion/lin2017/virtual_points.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/features2d.hpp>

namespace stillpoint {

std::vector<BinaryDescriptor> upright_descriptors(const cv::Mat& gray,
                                                  std::span<const MotionFeature> features) {
  std::vector<BinaryDescriptor> descriptors(features.size());
  std::vector<cv::KeyPoint> points;
  for (std::size_t i = 0; i < features.size(); ++i)
    points.emplace_back(features[i].pixel, 31.0F, 0.0F, 0.0F, 0, static_cast<int>(i));
  if (points.empty()) return descriptors;
  // One level, and no border: the image goes on mirrored.
  const cv::Ptr<cv::ORB> orb = cv::ORB::create(static_cast<int>(points.size()), 1.2F, 1, 0);
  cv::Mat rows;
  orb->compute(gray, points, rows);
  for (std::size_t row = 0; row < points.size(); ++row)
    std::memcpy(descriptors[static_cast<std::size_t>(points[row].class_id)].data(),
                rows.ptr(static_cast<int>(row)), sizeof(BinaryDescriptor));
  return descriptors;
}

int hamming(const BinaryDescriptor& a, const BinaryDescriptor& b) {
  int unlike = 0;
  for (std::size_t i = 0; i < a.size(); i += sizeof(std::uint64_t)) {
    std::uint64_t x = 0, y = 0;
    std::memcpy(&x, &a[i], sizeof x);
    std::memcpy(&y, &b[i], sizeof y);
    unlike += std::popcount(x ^ y);
  }
  return unlike;
}

std::vector<VirtualPoint> moved_on(const std::vector<VirtualPoint>& points, double seconds, int most_age) {
  std::vector<VirtualPoint> later;
  for (VirtualPoint point : points) {
    if (++point.age > most_age) continue;
    point.position += seconds * point.velocity;
    later.push_back(point);
  }
  return later;
}

std::vector<VirtualPoint> transformed(const std::vector<VirtualPoint>& points, const Pose& to_from) {
  std::vector<VirtualPoint> there = points;
  for (VirtualPoint& point : there) {
    point.position = to_from * point.position;
    point.velocity = to_from.linear() * point.velocity;
  }
  return there;
}

std::vector<cv::Point2f> projections(const std::vector<VirtualPoint>& points, const Camera& camera) {
  constexpr double kNearest = 0.05;  // m: nearer points are not projected
  constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();
  std::vector<cv::Point2f> pixels;
  for (const VirtualPoint& point : points) {
    if (point.position.z() < kNearest) {
      pixels.emplace_back(kNowhere, kNowhere);
      continue;
    }
    const Eigen::Vector2d straight = camera.project(point.position);
    const Eigen::Vector2d pixel = camera.has_distortion() ? camera.distort(straight) : straight;
    pixels.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
  }
  return pixels;
}

std::vector<int> match_virtual_points(const std::vector<VirtualPoint>& points,
                                      const std::vector<cv::Point2f>& projected,
                                      std::span<const MotionFeature> features,
                                      const std::vector<BinaryDescriptor>& descriptors,
                                      const Lin2017Config& config) {
  std::vector<int> matches(points.size(), -1);
  // Features by rows of the image, so that few are looked at.
  std::vector<std::size_t> by_row(features.size());
  for (std::size_t i = 0; i < by_row.size(); ++i) by_row[i] = i;
  std::stable_sort(by_row.begin(), by_row.end(),
                   [&](std::size_t a, std::size_t b) { return features[a].pixel.y < features[b].pixel.y; });
  const auto reach = static_cast<float>(config.virtual_px);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const cv::Point2f& at = projected[k];
    if (!std::isfinite(at.x) || !std::isfinite(at.y)) continue;
    int least = config.virtual_hamming + 1;
    auto i = std::lower_bound(by_row.begin(), by_row.end(), at.y - reach,
                              [&](std::size_t a, float y) { return features[a].pixel.y < y; });
    for (; i != by_row.end() && features[*i].pixel.y <= at.y + reach; ++i) {
      const cv::Point2f apart = features[*i].pixel - at;
      if (std::hypot(apart.x, apart.y) > reach) continue;
      const int unlike = hamming(points[k].descriptor, descriptors[*i]);
      if (unlike >= least) continue;
      least = unlike;
      matches[k] = static_cast<int>(*i);
    }
  }
  return matches;
}

}  // namespace stillpoint
