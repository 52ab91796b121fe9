#include "core/odometry/mapping.hpp"

#include <algorithm>
#include <set>

#include "core/odometry/matching.hpp"

namespace stillpoint {
namespace {

constexpr double kFuseRadiusPx = 3.0;  // at octave 0: both poses are known, so little is searched
constexpr int kFuseMaxDistance = 50;   // bits: the same corner, not one like it
constexpr int kFuseNeighbours = 10;    // keyframes: as ORB-SLAM2 has it with depth
constexpr double kFuseChi2 = 5.991;    // 95 % of a static point's squared deviations, two degrees of freedom

/// Looks for points in a keyframe; joins those found with what the keyframe has there.
int fuse_into(LocalMap& map, const std::vector<int>& points, int keyframe_id, const Camera& camera,
              const Config& config, const std::vector<double>& scales) {
  int fused = 0;
  std::vector<int> near;
  for (const int id : points) {
    if (!map.has_point(id)) continue;
    const MapPoint& point = map.point(id);
    const Keyframe& keyframe = map.keyframe(keyframe_id);
    if (std::any_of(point.observations.begin(), point.observations.end(),
                    [&](const Observation& o) { return o.keyframe == keyframe_id; }))
      continue;
    const Projection seen = project_point(point, camera, keyframe.camera_from_world, config.features);
    if (!seen.visible) continue;

    near.clear();
    const FeatureSet& features = *keyframe.features;
    const auto radius = static_cast<float>(kFuseRadiusPx * scales[static_cast<std::size_t>(seen.octave)]);
    features.find(seen.pixel, radius, seen.octave - 1, seen.octave, near);
    int best = kNone, best_distance = kFuseMaxDistance + 1;
    for (const int i : near) {
      const auto f = static_cast<std::size_t>(i);
      const double sigma = scales[static_cast<std::size_t>(features.keypoints[f].octave)];
      const cv::Point2f d = features.undistorted[f] - seen.pixel;
      if (d.dot(d) > kFuseChi2 * sigma * sigma) continue;
      const int distance = descriptor_distance(point.descriptor, features.descriptors[f]);
      if (distance < best_distance) best = i, best_distance = distance;
    }
    if (best == kNone) continue;
    const int present = keyframe.points[static_cast<std::size_t>(best)];
    if (present == kNone) {
      map.add_observation(id, keyframe_id, best);
    } else if (map.point(present).observations.size() > point.observations.size()) {
      map.merge_points(id, present);
    } else {
      map.merge_points(present, id);
    }
    ++fused;
  }
  return fused;
}

std::vector<int> points_of(const Keyframe& keyframe) {
  std::vector<int> points;
  std::copy_if(keyframe.points.begin(), keyframe.points.end(), std::back_inserter(points),
               [](int p) { return p != kNone; });
  return points;
}

/// How many map points a keyframe has in each part of the image.
class PointsByPlace {
 public:
  PointsByPlace(const Camera& camera, const Keyframe& keyframe)
      : keyframe_(keyframe),
        columns_(camera.width / kCell + 1),
        rows_(camera.height / kCell + 1),
        counts_(static_cast<std::size_t>(columns_ * rows_), 0) {
    for (int i = 0; i < keyframe.features->size(); ++i)
      if (keyframe.points[static_cast<std::size_t>(i)] != kNone) ++at(i);
  }

  /// The count of the part in which a feature lies.
  [[nodiscard]] int& at(int feature) {
    const cv::Point2f pixel = keyframe_.features->keypoints[static_cast<std::size_t>(feature)].pt;
    const int column = std::clamp(static_cast<int>(pixel.x) / kCell, 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>(pixel.y) / kCell, 0, rows_ - 1);
    return counts_[static_cast<std::size_t>(row * columns_ + column)];
  }

 private:
  static constexpr int kCell = 80;  // px of a part: 8 x 6 of them in 640 x 480
  const Keyframe& keyframe_;
  int columns_, rows_;
  std::vector<int> counts_;
};

}  // namespace

int create_points(LocalMap& map, int keyframe_id, const Camera& camera, const Config& config) {
  const Keyframe& keyframe = map.keyframe(keyframe_id);
  const FeatureSet& features = *keyframe.features;
  std::vector<std::pair<float, int>> by_depth;
  for (int i = 0; i < features.size(); ++i)
    if (features.depth[static_cast<std::size_t>(i)] > 0)
      by_depth.emplace_back(features.depth[static_cast<std::size_t>(i)], i);
  std::sort(by_depth.begin(), by_depth.end());

  const Pose world_from_camera = keyframe.camera_from_world.inverse();
  PointsByPlace by_place(camera, keyframe);
  const double far = camera.depth_limit(config.map.far_depth_m);
  int near = 0, created = 0;
  for (const auto& [depth, i] : by_depth) {
    // Far points are less exact, but where there are no others they alone tell the room from what stands
    // before it.
    const bool wanted = depth <= far || near < config.map.min_new_points;
    if (!wanted && by_place.at(i) >= config.map.min_cell_points) continue;
    ++near;
    if (keyframe.points[static_cast<std::size_t>(i)] != kNone) continue;
    ++by_place.at(i);
    const cv::Point2f pixel = features.undistorted[static_cast<std::size_t>(i)];
    const Eigen::Vector3d point = world_from_camera * camera.back_project({pixel.x, pixel.y}, depth);
    const int id = map.add_point(point, keyframe_id, i);
    map.update_point(id, config.features.scale_factor, config.features.levels);
    ++created;
  }
  return created;
}

int fuse_neighbours(LocalMap& map, int keyframe_id, const Camera& camera, const Config& config) {
  const std::vector<double> scales = octave_scales(config.features);
  auto neighbours = map.covisible(keyframe_id);
  if (static_cast<int>(neighbours.size()) > kFuseNeighbours) neighbours.resize(kFuseNeighbours);
  int fused = 0;
  std::set<int> theirs;
  for (const auto& [neighbour, shared] : neighbours) {
    fused += fuse_into(map, points_of(map.keyframe(keyframe_id)), neighbour, camera, config, scales);
    for (const int point : points_of(map.keyframe(neighbour))) theirs.insert(point);
  }
  fused += fuse_into(map, {theirs.begin(), theirs.end()}, keyframe_id, camera, config, scales);
  for (const int point : points_of(map.keyframe(keyframe_id)))
    map.update_point(point, config.features.scale_factor, config.features.levels);
  return fused;
}

int cull_points(LocalMap& map, int newest_keyframe, const Config& config) {
  constexpr int kYoung = 3;  // keyframes: older points have proved themselves
  std::vector<int> young;
  for (auto it = map.keyframes().rbegin();
       it != map.keyframes().rend() && it->first > newest_keyframe - kYoung - 1; ++it)
    for (const int point : points_of(it->second))
      if (map.point(point).born_keyframe >= newest_keyframe - kYoung) young.push_back(point);
  std::sort(young.begin(), young.end());
  young.erase(std::unique(young.begin(), young.end()), young.end());

  int culled = 0;
  for (const int id : young) {
    const MapPoint& point = map.point(id);
    const int age = newest_keyframe - point.born_keyframe;
    const bool seldom_found = point.found < config.map.min_found_ratio * point.visible;
    const bool seen_once = age >= 2 && point.observations.size() < 2;
    if (!seldom_found && !seen_once) continue;
    map.remove_point(id);
    ++culled;
  }
  return culled;
}

int cull_keyframes(LocalMap& map, int newest_keyframe, const Camera& camera, const Config& config) {
  // Keyframes: a point seen by so many is not lost with one, as ORB-SLAM has it.
  constexpr int kSeenByOthers = 3;
  const double far = camera.depth_limit(config.map.far_depth_m);
  // Asked for every sight of every point, which in a full map is most of culling.
  std::vector<const FeatureSet*> features_of;
  if (!map.keyframes().empty())
    features_of.resize(static_cast<std::size_t>(map.keyframes().rbegin()->first) + 1);
  for (const auto& [id, keyframe] : map.keyframes())
    features_of[static_cast<std::size_t>(id)] = keyframe.features.get();
  int culled = 0;
  for (const auto& [id, shared] : map.covisible(newest_keyframe)) {
    if (id == map.keyframes().begin()->first) continue;  // the first keyframe holds the map in place
    const Keyframe& keyframe = map.keyframe(id);
    int points = 0, redundant = 0;
    for (std::size_t f = 0; f < keyframe.points.size(); ++f) {
      if (keyframe.points[f] == kNone || keyframe.features->depth[f] > far) continue;
      ++points;
      const int octave = keyframe.features->keypoints[f].octave;
      int others = 0;
      for (const Observation& o : map.point(keyframe.points[f]).observations) {
        if (o.keyframe != id && features_of[static_cast<std::size_t>(o.keyframe)]
                                        ->keypoints[static_cast<std::size_t>(o.feature)]
                                        .octave <= octave + 1)
          ++others;
        if (others >= kSeenByOthers) break;  // in a full map dozens see it
      }
      if (others >= kSeenByOthers) ++redundant;
    }
    if (points > 0 && redundant > config.map.cull_redundancy * points) {
      map.retire_keyframe(id);
      ++culled;
    }
  }
  while (static_cast<int>(map.keyframes().size()) > config.map.max_keyframes) {
    map.retire_keyframe(map.keyframes().begin()->first);
    ++culled;
  }
  return culled;
}

}  // namespace stillpoint
