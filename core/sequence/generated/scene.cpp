#include "core/sequence/generated/scene.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace stillpoint::generated {

std::uint16_t Scene::add(const Surface& surface) {
  surfaces.push_back(surface);
  return static_cast<std::uint16_t>(surfaces.size() - 1);
}

ShadowPlane cast_shadows(const std::vector<Primitive>& fixed, float height, const Vector2f& corner,
                         const Vector2f& size, float blur_m) {
  ShadowPlane plane;
  plane.height = height;
  plane.corner = corner;
  plane.texels_per_metre = 80;
  plane.light = cv::Mat(static_cast<int>(size.y() * plane.texels_per_metre),
                        static_cast<int>(size.x() * plane.texels_per_metre), CV_8UC1, cv::Scalar(255));
  const Vector3f light = light_direction();
  for (std::size_t i = 1; i < fixed.size(); ++i) {  // 0 is the room
    const Primitive& p = fixed[i];
    const Matrix3f world_from_local = p.local_from_world.inverse();
    std::vector<cv::Point> shadow;
    float lowest = 1e9f, highest = -1e9f;
    for (int k = 0; k < 8; ++k) {
      Vector3f local(k & 1 ? 1.0f : -1.0f, k & 2 ? 1.0f : -1.0f, k & 4 ? 1.0f : -1.0f);
      if (p.shape == Shape::kCone) {
        const float r = std::max(p.radius_start, p.radius_end);
        local = {local.x() * r, local.y() * r, local.z() > 0 ? p.length : 0};
      }
      const Vector3f world = p.centre + world_from_local * local;
      lowest = std::min(lowest, world.z());
      highest = std::max(highest, world.z());
      const Vector2f fallen = world.head<2>() - light.head<2>() / light.z() * (world.z() - height) - corner;
      shadow.emplace_back(cvRound(fallen.x() * plane.texels_per_metre),
                          cvRound(fallen.y() * plane.texels_per_metre));
    }
    if (lowest < height - 0.02f || lowest > 2.3f || highest - lowest < 0.005f) continue;  // paper throws none
    std::vector<cv::Point> hull;
    cv::convexHull(shadow, hull);
    cv::fillConvexPoly(plane.light, hull, cv::Scalar(70));
  }
  cv::GaussianBlur(plane.light, plane.light, cv::Size(0, 0),
                   static_cast<double>(blur_m * plane.texels_per_metre));
  return plane;
}

}  // namespace stillpoint::generated
