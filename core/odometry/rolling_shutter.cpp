#include "core/odometry/rolling_shutter.hpp"

#include <algorithm>

#include "core/median.hpp"

namespace stillpoint {
namespace {

double median_depth(const std::vector<float>& depth) {
  constexpr double kRoom = 2.0;  // m: where nothing was measured
  std::vector<float> measured;
  std::copy_if(depth.begin(), depth.end(), std::back_inserter(measured), [](float z) { return z > 0; });
  if (measured.empty()) return kRoom;
  return median_of(measured);
}

}  // namespace

void correct_rolling_shutter(const Camera& camera, const Vector6d& velocity,
                             const std::vector<cv::Point2f>& pixels, std::vector<cv::Point2f>& undistorted,
                             std::vector<float>& depth) {
  if (camera.readout_s == 0.0 || velocity.isZero()) return;
  const double usual = median_depth(depth);
  const Eigen::Vector3d linear = velocity.head<3>(), angular = velocity.tail<3>();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const double after_middle = camera.row_time(static_cast<double>(pixels[i].y));
    const Eigen::Vector3d p = camera.back_project({undistorted[i].x, undistorted[i].y},
                                                  depth[i] > 0 ? static_cast<double>(depth[i]) : usual);
    // To first order: over a few hundredths of a second no camera turns far.
    const Eigen::Vector3d at_middle = p - after_middle * (linear + angular.cross(p));
    if (at_middle.z() < 0.05) continue;
    const Eigen::Vector2d pixel = camera.project(at_middle);
    undistorted[i] = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
    if (depth[i] > 0) depth[i] = static_cast<float>(at_middle.z());
  }
}

}  // namespace stillpoint
