#pragma once

#include <cmath>
#include <opencv2/core.hpp>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// A rigid, textured, bent wall about 2 m off, as a camera anywhere before it sees it, without noise: what
/// poses are recovered from. A patch of it may be covered by something that goes along with the camera.
struct BentWall {
  double brightness = 0.0;  ///< grey levels added
  double gain = 1.0;        ///< times the grey levels
  bool companion = false;   ///< a flat thing 1.2 m before the camera, at rest in its image
  int salt = 0;

  static double surface(double x, double y) {
    return 2.0 + 0.25 * std::sin(1.7 * x) + 0.2 * std::cos(2.3 * y);
  }
  [[nodiscard]] double texture(double x, double y) const {
    return 120 + 40 * std::sin(23 * x + 3 * std::sin(5 * y)) +
           35 * std::cos(19 * y + 2 * std::sin(7 * x + salt)) + 20 * std::sin(41 * x - 37 * y);
  }
  static cv::Rect companion_at(const Camera& camera) {
    return {camera.width / 5, camera.height / 4, camera.width / 3, camera.height / 2};
  }

  [[nodiscard]] Frame render(const Camera& camera, const Pose& world_from_camera, int index = 0) const {
    Frame frame;
    frame.index = index;
    frame.timestamp = frame.depth_timestamp = index / 30.0;
    frame.gray.create(camera.height, camera.width, CV_8UC1);
    frame.depth.create(camera.height, camera.width, CV_32FC1);
    const Eigen::Vector3d origin = world_from_camera.translation();
    for (int v = 0; v < camera.height; ++v)
      for (int u = 0; u < camera.width; ++u) {
        const Eigen::Vector3d ray = camera.back_project({u, v}, 1.0);
        const Eigen::Vector3d way = world_from_camera.linear() * ray;
        double z = 2.0;
        for (int i = 0; i < 30; ++i) {
          const Eigen::Vector3d at = origin + z * way;
          z = (surface(at.x(), at.y()) - origin.z()) / way.z();
        }
        Eigen::Vector3d at = origin + z * way;
        double value = texture(at.x(), at.y());
        if (companion && companion_at(camera).contains({u, v})) {
          z = 1.2;
          value = texture(1.2 * ray.x() + 7.0, 1.2 * ray.y());
        }
        frame.gray.at<uchar>(v, u) = cv::saturate_cast<uchar>(gain * value + brightness);
        frame.depth.at<float>(v, u) = static_cast<float>(z);
      }
    return frame;
  }
};

}  // namespace stillpoint
