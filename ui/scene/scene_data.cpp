#include "ui/scene/scene_data.hpp"

#include <limits>

namespace stillpoint {

SceneBounds bounds(const SceneData& scene) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  SceneBounds box{Eigen::Vector3d::Constant(kInfinity), Eigen::Vector3d::Constant(-kInfinity)};
  const auto include = [&box](const Eigen::Vector3d& point) {
    if (!point.allFinite()) return;
    box.low = box.low.cwiseMin(point);
    box.high = box.high.cwiseMax(point);
  };
  for (const ScenePath& path : scene.paths) {
    for (const Eigen::Vector3f& position : path.positions) include(position.cast<double>());
  }
  for (const Pose& keyframe : scene.keyframes) include(keyframe.translation());
  if (scene.current) include(scene.current->translation());
  if (!box.low.allFinite()) {
    for (const ScenePoint& point : scene.points) include(point.position.cast<double>());
  }
  if (!box.low.allFinite()) return {Eigen::Vector3d::Constant(-0.5), Eigen::Vector3d::Constant(0.5)};
  return box;
}

}  // namespace stillpoint
