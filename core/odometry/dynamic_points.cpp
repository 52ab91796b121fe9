// What the motion method's judgement does to the map.
#include "core/odometry/mapping.hpp"

namespace stillpoint {

int remove_dynamic_points(LocalMap& map, const cv::Mat& depth, const cv::Mat& mask,
                          const Pose& camera_from_world, int about, const Camera& camera,
                          const Config& config) {
  constexpr double kLikeDepth =
      0.1;  // m: the point lies on what is dynamic or before it, where nothing is now
  if (mask.empty() || depth.empty() || map.keyframes().empty()) return 0;
  int removed = 0;
  // Not only what the last frame showed: what has gone on meanwhile stays behind in the map.
  for (const int id : local_points(map, {}, about, config.map.max_local_keyframes)) {
    const Eigen::Vector3d p = camera_from_world * map.point(id).position;
    if (p.z() < kNearestProjected) continue;
    const Eigen::Vector2d pixel = camera.distort(camera.project(p));
    const int x = cvRound(pixel.x()), y = cvRound(pixel.y());
    if (x < 0 || y < 0 || x >= mask.cols || y >= mask.rows || mask.at<uchar>(y, x) == 0) continue;
    const float z = depth.at<float>(y, x);
    if (z > 0 && p.z() < z + kLikeDepth + camera.stereo_sigma(static_cast<double>(z))) {
      map.remove_moving_point(id);
      ++removed;
    }
  }
  return removed;
}

}  // namespace stillpoint
