// What the motion method's judgement does to features and map.
#include <algorithm>
#include <array>

#include "core/odometry/odometry.hpp"

namespace stillpoint {

bool Odometry::leaves_too_little(const Current& current) const {
  constexpr int kColumns = 8, kRows = 6;
  constexpr int kLeastParts = 5;  // of those 48 that features must lie in, or they tell no room from a mover
  if (current.record_of.size() == current.records.size()) return false;
  std::array<bool, kColumns * kRows> before{}, after{};
  for (const FeatureRecord& feature : current.records) {
    const int column =
        std::clamp(static_cast<int>(feature.pixel.x) * kColumns / camera_.width, 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>(feature.pixel.y) * kRows / camera_.height, 0, kRows - 1);
    const auto part = static_cast<std::size_t>(row * kColumns + column);
    before[part] = true;
    after[part] = after[part] || feature.fate != FeatureFate::removed;
  }
  const auto had = std::count(before.begin(), before.end(), true);
  const auto has = std::count(after.begin(), after.end(), true);
  return has < std::min<std::ptrdiff_t>(kLeastParts, had);
}

void Odometry::purge_moving_points(const Frame& frame, const cv::Mat& mask, const Pose& camera_from_world) {
  constexpr double kLikeDepth = 0.1;  // m: the point lies on what moves or before it, where nothing is now
  if (mask.empty() || !config_.map.purge_moving || map_.keyframes().empty()) return;
  // Not only what the last frame showed: what has gone on meanwhile stays behind in the map.
  for (const int id : local_points()) {
    const Eigen::Vector3d p = camera_from_world * map_.point(id).position;
    if (p.z() < 0.05) continue;
    const Eigen::Vector2d pixel = camera_.distort(camera_.project(p));
    const int x = cvRound(pixel.x()), y = cvRound(pixel.y());
    if (x < 0 || y < 0 || x >= mask.cols || y >= mask.rows || mask.at<uchar>(y, x) == 0) continue;
    const float z = frame.depth.at<float>(y, x);
    if (z > 0 && p.z() < z + kLikeDepth) {
      map_.remove_moving_point(id);
    }
  }
}

}  // namespace stillpoint
