#include "core/export/map_export.hpp"

#include <cmath>
#include <optional>

namespace stillpoint {
namespace {

constexpr int kNormalReach = 4;          // px to each side: farther apart than the noise of depth is steep
constexpr double kSurfaceStep = 0.04;    // of depth, from a side to the middle: more is an edge
constexpr double kLeastAgreement = 0.8;  // mean length of the unit normals' sum

/// The surface's normal towards the camera at a pixel, camera coordinates; nothing at edges and where depth
/// lacks.
std::optional<Eigen::Vector3d> surface_normal(const Camera& camera, const cv::Mat& depth,
                                              const cv::Point& at) {
  const cv::Rect inside(kNormalReach, kNormalReach, depth.cols - 2 * kNormalReach,
                        depth.rows - 2 * kNormalReach);
  if (!inside.contains(at)) return std::nullopt;
  const double middle = static_cast<double>(depth.at<float>(at));
  const auto point = [&](int dx, int dy) -> std::optional<Eigen::Vector3d> {
    const double z = static_cast<double>(depth.at<float>(at.y + dy, at.x + dx));
    if (!(z > 0.0) || std::abs(z - middle) > kSurfaceStep * middle) return std::nullopt;
    const Eigen::Vector2d pixel(at.x + dx, at.y + dy);
    return camera.back_project(camera.has_distortion() ? camera.undistorted(pixel) : pixel, z);
  };
  const auto left = point(-kNormalReach, 0), right = point(kNormalReach, 0), above = point(0, -kNormalReach),
             below = point(0, kNormalReach);
  if (!(middle > 0.0) || !left || !right || !above || !below) return std::nullopt;
  const Eigen::Vector3d normal = (*below - *above).cross(*right - *left);
  if (!(normal.norm() > 0.0)) return std::nullopt;
  return normal.normalized();
}

}  // namespace

void PointNormals::add(const Frame& frame, const FrameRecord& record, const Pose& world_from_camera) {
  if (!frame.has_depth()) return;
  for (const FeatureRecord& feature : record.features) {
    if (feature.fate != FeatureFate::inlier || feature.map_point == kNone) continue;
    const auto normal = surface_normal(camera_, frame.depth, feature.pixel);
    if (!normal) continue;
    Sum& sum = sums_[feature.map_point];
    sum.normals += world_from_camera.linear() * *normal;
    ++sum.count;
  }
}

std::vector<Eigen::Vector3f> PointNormals::of(const std::vector<SavedPoint>& points) const {
  std::vector<Eigen::Vector3f> normals;
  normals.reserve(points.size());
  for (const SavedPoint& point : points) {
    const auto found = sums_.find(point.id);
    const bool known =
        found != sums_.end() && found->second.normals.norm() >= kLeastAgreement * found->second.count;
    normals.push_back(known ? Eigen::Vector3f(found->second.normals.normalized().cast<float>())
                            : Eigen::Vector3f::Zero());
  }
  return normals;
}

}  // namespace stillpoint
