#pragma once

#include <map>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/chunked_list.hpp"
#include "core/config.hpp"
#include "core/geometry/se3.hpp"
#include "core/odometry/feature_set.hpp"
#include "core/odometry/map_id.hpp"

namespace stillpoint {

class ByteStore;
class ShelvedFeatures;

/// A keyframe's sight of a map point.
struct Observation {
  int keyframe = kNone;
  int feature = kNone;  ///< index into the keyframe's features
};

/// A point of the scene, in world coordinates.
struct MapPoint {
  int id = kNone;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m
  Descriptor descriptor{};                             ///< the observation's nearest to all the others
  std::vector<Observation> observations;               ///< in the order they were made
  Eigen::Vector3d viewing_direction =
      Eigen::Vector3d::Zero();                    ///< mean unit vector from the cameras to the point
  double min_distance = 0.0, max_distance = 0.0;  ///< m: where its scale lies within the pyramid
  int visible = 1;                                ///< frames whose view should hold it
  int found = 1;                                  ///< … and in which it was matched as an inlier
  int born_keyframe = kNone;
};

/// A frame kept in the map.
struct Keyframe {
  int id = kNone;
  int frame_index = 0;
  double timestamp = 0.0;  ///< s
  Pose camera_from_world = Pose::Identity();
  std::shared_ptr<const FeatureSet> features;  ///< static features only; shared between copies of the map
  std::vector<int> points;                     ///< map point id a feature, or kNone
  std::shared_ptr<const ShelvedFeatures> shelved{};  ///< the features as they were put by; null while not
};

/// A keyframe that left the map: its pose hangs on another keyframe's, or on none and is final.
struct RetiredKeyframe {
  int id = kNone, frame_index = 0;
  double timestamp = 0.0;
  int anchor = kNone;  ///< keyframe it hangs on; kNone: `camera_from_anchor` is camera_from_world
  Pose camera_from_anchor = Pose::Identity();
};

/// A point that left the map because it was found to move: for display only.
struct MovedPoint {
  int id = kNone;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, where it was last held to be
};

/// What is in any of the lists, each once, ascending; without kNone.
[[nodiscard]] std::vector<int> each_once(const std::vector<const std::vector<int>*>& lists);

/// Keyframes and map points, and who sees what. Plain values throughout: a copy is a checkpoint.
class LocalMap {
 public:
  /// Adds a keyframe; `points` names the map points its features already belong to. Returns its id.
  int add_keyframe(Keyframe keyframe);

  /// Adds a point first seen by `keyframe`'s `feature`. Returns its id.
  int add_point(const Eigen::Vector3d& position, int keyframe, int feature);

  void add_observation(int point, int keyframe, int feature);

  /// Takes an observation away; a point left with none goes with it.
  void remove_observation(int point, int keyframe);
  void remove_point(int point);

  /// Removes a point that moves, and remembers where it was.
  void remove_moving_point(int point);
  /// The last of these, at most kMovedKept, oldest first.
  [[nodiscard]] const std::vector<MovedPoint>& moved_points() const { return moved_; }
  static constexpr std::size_t kMovedKept = 1000;  // points, which are only shown: memory stays bounded

  /// Moves every observation of `from` to `into` where that keyframe does not see it yet, and removes `from`.
  void merge_points(int from, int into);

  /// Takes a keyframe out; its pose stays known through the keyframe it shares most points with.
  void retire_keyframe(int keyframe);

  /// Recomputes descriptor, viewing direction and distance range from the observations.
  void update_point(int point, double scale_factor, int levels);

  [[nodiscard]] const std::map<int, Keyframe>& keyframes() const { return keyframes_; }
  [[nodiscard]] const ChunkedList<RetiredKeyframe>& retired() const { return retired_; }
  [[nodiscard]] std::size_t point_count() const { return points_.size(); }
  [[nodiscard]] bool has_point(int id) const { return points_.contains(id); }
  [[nodiscard]] const MapPoint& point(int id) const { return points_.at(id); }
  [[nodiscard]] MapPoint& point(int id) { return points_.at(id); }
  [[nodiscard]] const Keyframe& keyframe(int id) const { return keyframes_.at(id); }
  [[nodiscard]] Keyframe& keyframe(int id) { return keyframes_.at(id); }
  [[nodiscard]] bool has_keyframe(int id) const { return keyframes_.contains(id); }

  /// Puts the keyframes' features by, each once, for copies that drop them.
  void shelve_features(ByteStore& store);
  /// Lets go of features that were put by: nothing but restore_features() may be asked of the map then.
  void drop_features();
  /// Has them again, as they were. @throws InputError when the disk does not give them back
  void restore_features();

  /// Ids of all points, ascending.
  [[nodiscard]] std::vector<int> point_ids() const;

  /// Keyframes that share points with this one, most first (then by id), with the number shared.
  [[nodiscard]] std::vector<std::pair<int, int>> covisible(int keyframe, int min_shared = 15) const;

  /// The same for a set of points: the keyframes that see them.
  [[nodiscard]] std::vector<std::pair<int, int>> observers(const std::vector<int>& points) const;

  /// camera_from_world of a keyframe of any age, those retired included.
  [[nodiscard]] Pose pose_of(int keyframe) const;

 private:
  std::map<int, Keyframe> keyframes_;
  std::unordered_map<int, MapPoint> points_;  // never iterated where order matters
  ChunkedList<RetiredKeyframe> retired_;      // grows with a run, and copies share it
  std::vector<MovedPoint> moved_;
  int next_keyframe_ = 0, next_point_ = 0;
};

/// Points of the keyframes about those that see the matched ones; without any, of those about a keyframe (the
/// newest, where it has left the map). Each once, ascending.
[[nodiscard]] std::vector<int> local_points(const LocalMap& map, const std::vector<int>& matched, int about,
                                            int max_keyframes);

}  // namespace stillpoint
