#include "core/odometry/local_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/odometry/feature_shelf.hpp"

namespace stillpoint {
namespace {

/// Keyframes by how many points they share, most first, then by id. @param counts by keyframe id
std::vector<std::pair<int, int>> by_weight(const std::vector<int>& counts, int min_shared) {
  std::vector<std::pair<int, int>> order;
  for (std::size_t keyframe = 0; keyframe < counts.size(); ++keyframe)
    if (counts[keyframe] > 0 && counts[keyframe] >= min_shared)
      order.emplace_back(static_cast<int>(keyframe), counts[keyframe]);
  std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return a.second != b.second ? a.second > b.second : a.first < b.first;
  });
  return order;
}

Eigen::Vector3d centre(const Pose& camera_from_world) {
  return -(camera_from_world.linear().transpose() * camera_from_world.translation());
}

}  // namespace

std::vector<int> each_once(const std::vector<const std::vector<int>*>& lists) {
  // Most are in several lists: a bit for each is sorted as it is set.
  constexpr int kBits = 64;
  int first = std::numeric_limits<int>::max(), last = kNone;
  for (const std::vector<int>* list : lists)
    for (const int id : *list)
      if (id != kNone) first = std::min(first, id), last = std::max(last, id);
  std::vector<int> ids;
  if (last == kNone) return ids;
  std::vector<std::uint64_t> marks(static_cast<std::size_t>((last - first) / kBits) + 1, 0);
  for (const std::vector<int>* list : lists)
    for (const int id : *list)
      if (id != kNone)
        marks[static_cast<std::size_t>((id - first) / kBits)] |= std::uint64_t{1} << (id - first) % kBits;
  std::size_t count = 0;
  for (const std::uint64_t mark : marks) count += static_cast<std::size_t>(std::popcount(mark));
  ids.reserve(count);
  for (std::size_t i = 0; i < marks.size(); ++i)
    for (std::uint64_t mark = marks[i]; mark != 0; mark &= mark - 1)
      ids.push_back(first + static_cast<int>(i) * kBits + std::countr_zero(mark));
  return ids;
}

int LocalMap::add_keyframe(Keyframe keyframe) {
  keyframe.id = next_keyframe_++;
  for (std::size_t feature = 0; feature < keyframe.points.size(); ++feature)
    if (keyframe.points[feature] != kNone)
      points_.at(keyframe.points[feature]).observations.push_back({keyframe.id, static_cast<int>(feature)});
  const int id = keyframe.id;
  keyframes_.emplace(id, std::move(keyframe));
  return id;
}

int LocalMap::add_point(const Eigen::Vector3d& position, int keyframe, int feature) {
  MapPoint point;
  point.id = next_point_++;
  point.position = position;
  point.born_keyframe = keyframe;
  const int id = point.id;
  points_.emplace(id, std::move(point));
  add_observation(id, keyframe, feature);
  return id;
}

void LocalMap::add_observation(int point, int keyframe, int feature) {
  points_.at(point).observations.push_back({keyframe, feature});
  keyframes_.at(keyframe).points[static_cast<std::size_t>(feature)] = point;
}

void LocalMap::remove_observation(int point, int keyframe) {
  auto& observations = points_.at(point).observations;
  const auto it = std::find_if(observations.begin(), observations.end(),
                               [&](const Observation& o) { return o.keyframe == keyframe; });
  if (it == observations.end()) return;
  keyframes_.at(keyframe).points[static_cast<std::size_t>(it->feature)] = kNone;
  observations.erase(it);
  if (observations.empty()) points_.erase(point);
}

void LocalMap::remove_point(int point) {
  for (const Observation& o : points_.at(point).observations)
    keyframes_.at(o.keyframe).points[static_cast<std::size_t>(o.feature)] = kNone;
  points_.erase(point);
}

void LocalMap::remove_moving_point(int point) {
  if (moved_.size() >= kMovedKept) moved_.erase(moved_.begin());
  moved_.push_back({point, points_.at(point).position});
  remove_point(point);
}

void LocalMap::merge_points(int from, int into) {
  if (from == into) return;
  const std::vector<Observation> moved = points_.at(from).observations;
  const int found = points_.at(from).found, visible = points_.at(from).visible;
  remove_point(from);
  MapPoint& target = points_.at(into);
  for (const Observation& o : moved) {
    const bool seen = std::any_of(target.observations.begin(), target.observations.end(),
                                  [&](const Observation& other) { return other.keyframe == o.keyframe; });
    if (!seen) add_observation(into, o.keyframe, o.feature);
  }
  target.found += found;
  target.visible += visible;
}

void LocalMap::retire_keyframe(int id) {
  const auto neighbours = covisible(id, 1);
  const Keyframe& keyframe = keyframes_.at(id);
  RetiredKeyframe retired{id, keyframe.frame_index, keyframe.timestamp, kNone, keyframe.camera_from_world};
  if (!neighbours.empty()) {
    retired.anchor = neighbours.front().first;
    retired.camera_from_anchor =
        keyframe.camera_from_world * keyframes_.at(retired.anchor).camera_from_world.inverse();
  }
  const std::vector<int> points = keyframe.points;
  for (const int point : points)
    if (point != kNone) remove_observation(point, id);
  keyframes_.erase(id);
  retired_.push_back(retired);
}

void LocalMap::update_point(int id, double scale_factor, int levels) {
  MapPoint& point = points_.at(id);
  const std::size_t count = point.observations.size();
  // Few points are seen by more keyframes than fit on the stack.
  cv::AutoBuffer<const Descriptor*, 64> descriptors(count);
  point.viewing_direction.setZero();
  for (std::size_t i = 0; i < count; ++i) {
    const Observation& o = point.observations[i];
    const Keyframe& keyframe = keyframes_.at(o.keyframe);
    descriptors[i] = &keyframe.features->descriptors[static_cast<std::size_t>(o.feature)];
    point.viewing_direction += (point.position - centre(keyframe.camera_from_world)).normalized();
  }
  point.viewing_direction.normalize();

  // The descriptor with the least median distance to the others speaks for the point.
  int best_median = std::numeric_limits<int>::max();
  cv::AutoBuffer<int, 64> distances(count);
  const std::size_t middle = (count - 1) / 2;
  for (std::size_t i = 0; i < count; ++i) {
    // Its median is less than the best if more than half of the distances are: mostly it is soon seen that
    // they are not.
    std::size_t less = 0, tried = 0;
    for (; tried < count && less + (count - tried) > middle; ++tried) {
      distances[tried] = descriptor_distance(*descriptors[i], *descriptors[tried]);
      less += distances[tried] < best_median;
    }
    if (less <= middle) continue;
    std::nth_element(distances.data(), distances.data() + middle, distances.data() + count);
    best_median = distances[middle], point.descriptor = *descriptors[i];
  }

  const Observation& latest = point.observations.back();
  const Keyframe& keyframe = keyframes_.at(latest.keyframe);
  const int octave = keyframe.features->keypoints[static_cast<std::size_t>(latest.feature)].octave;
  const double distance = (point.position - centre(keyframe.camera_from_world)).norm();
  point.max_distance = distance * std::pow(scale_factor, octave);
  point.min_distance = point.max_distance / std::pow(scale_factor, levels - 1);
}

void LocalMap::shelve_features(ByteStore& store) {
  for (auto& [id, keyframe] : keyframes_)
    if (!keyframe.shelved)
      keyframe.shelved = std::make_shared<const ShelvedFeatures>(store, keyframe.features);
}

void LocalMap::drop_features() {
  for (auto& [id, keyframe] : keyframes_)
    if (keyframe.shelved) keyframe.features.reset();
}

void LocalMap::restore_features() {
  for (auto& [id, keyframe] : keyframes_)
    if (!keyframe.features) keyframe.features = keyframe.shelved->get();
}

std::vector<int> LocalMap::point_ids() const {
  std::vector<int> ids;
  ids.reserve(points_.size());
  for (const auto& entry : points_) ids.push_back(entry.first);
  std::sort(ids.begin(), ids.end());
  return ids;
}

std::vector<std::pair<int, int>> LocalMap::covisible(int keyframe, int min_shared) const {
  std::vector<int> shared(static_cast<std::size_t>(next_keyframe_), 0);
  for (const int point : keyframes_.at(keyframe).points)
    if (point != kNone)
      for (const Observation& o : points_.at(point).observations)
        if (o.keyframe != keyframe) ++shared[static_cast<std::size_t>(o.keyframe)];
  return by_weight(shared, min_shared);
}

std::vector<std::pair<int, int>> LocalMap::observers(const std::vector<int>& points) const {
  std::vector<int> seen(static_cast<std::size_t>(next_keyframe_), 0);
  for (const int point : points)
    if (const auto it = points_.find(point); it != points_.end())
      for (const Observation& o : it->second.observations) ++seen[static_cast<std::size_t>(o.keyframe)];
  return by_weight(seen, 1);
}

Pose LocalMap::pose_of(int keyframe) const {
  Pose camera_from_ancestor = Pose::Identity();
  while (true) {
    if (const auto it = keyframes_.find(keyframe); it != keyframes_.end())
      return camera_from_ancestor * it->second.camera_from_world;
    // Those that left last are asked for most.
    auto it = std::prev(retired_.end());
    while (it->id != keyframe) --it;
    camera_from_ancestor = camera_from_ancestor * it->camera_from_anchor;
    if (it->anchor == kNone) return camera_from_ancestor;
    keyframe = it->anchor;
  }
}

std::vector<int> local_points(const LocalMap& map, const std::vector<int>& matched, int about,
                              int max_keyframes) {
  std::vector<std::pair<int, int>> seeds = map.observers(matched);
  if (seeds.empty()) {  // nothing matched yet: about where the camera was last
    const int reference = map.has_keyframe(about) ? about : map.keyframes().rbegin()->first;
    seeds = map.covisible(reference);
    seeds.insert(seeds.begin(), {reference, 0});
  }
  const auto wanted = static_cast<std::size_t>(max_keyframes);
  if (seeds.size() > wanted) seeds.resize(wanted);
  std::vector<int> keyframes;
  for (const auto& seed : seeds) keyframes.push_back(seed.first);
  // Room left goes to the neighbours of what the frame sees most of, as long as there are others.
  const std::size_t most = std::min(wanted, map.keyframes().size());
  for (std::size_t i = 0; i < seeds.size() && keyframes.size() < most; ++i)
    for (const auto& [neighbour, shared] : map.covisible(seeds[i].first))
      if (keyframes.size() < most &&
          std::find(keyframes.begin(), keyframes.end(), neighbour) == keyframes.end())
        keyframes.push_back(neighbour);

  std::vector<const std::vector<int>*> seen;
  for (const int keyframe : keyframes) seen.push_back(&map.keyframe(keyframe).points);
  return each_once(seen);
}

}  // namespace stillpoint
