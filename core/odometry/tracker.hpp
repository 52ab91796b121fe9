#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/odometry/camera_path.hpp"
#include "core/odometry/matching.hpp"
#include "core/odometry/pose_solver.hpp"
#include "core/odometry/tracked_frame.hpp"

namespace stillpoint {

/// METHOD.md §2.2 and §2.3: a frame's pose from its features and the local map. Predicts, matches, and
/// refines. What it took and found goes into the record. A value; its memory is the camera's path.
class Tracker {
 public:
  Tracker(const Camera& camera, const Config& config);

  /// Goes by another config from now on. @param config of the same features.levels and features.scale_factor
  void adopt(const Config& config) { config_ = config; }
  [[nodiscard]] const CameraPath& path() const { return path_; }
  [[nodiscard]] CameraPath& path() { return path_; }
  /// Of the pixels of each octave: standard deviation, px.
  [[nodiscard]] const std::vector<double>& scales() const { return scales_; }
  /// How many matches must agree with a pose for it to be believed.
  [[nodiscard]] int inliers_needed() const;

  /// §2.2, the initial pose: from where the frame is held to be now, by what the frame before saw; where that
  /// fails or is stale, by EPnP inside RANSAC over the local map.
  /// @param consensus_seed given where dynamic objects may be among the features, so that least squares alone
  /// is not to be relied on: the pose that most of the image agrees on is sought, by samples of this
  /// seed
  /// @returns whether there is a pose; `frame` and its matches are at it then
  [[nodiscard]] bool estimate(const LocalMap& map, TrackedFrame& frame, FrameRecord& record,
                              std::optional<std::uint32_t> consensus_seed = std::nullopt) const;

  /// §2.3: matches the local map about the frame's pose and refines it over all matches, eq. (5).
  [[nodiscard]] PoseRefinement refine_by_local_map(const LocalMap& map, TrackedFrame& frame,
                                                   FrameRecord& record) const;
  /// The same from another pose, earlier matches forgotten.
  [[nodiscard]] PoseRefinement search_again(const LocalMap& map, const Pose& camera_from_world,
                                            TrackedFrame& frame, FrameRecord& record) const;

 private:
  [[nodiscard]] bool estimate_from_last(const LocalMap& map, TrackedFrame& frame, FrameRecord& record,
                                        std::optional<std::uint32_t> consensus_seed) const;
  [[nodiscard]] bool estimate_by_epnp(const LocalMap& map, TrackedFrame& frame, FrameRecord& record) const;
  [[nodiscard]] std::vector<Candidate> points_of_last(const LocalMap& map, const Pose& predicted,
                                                      double radius_px) const;
  [[nodiscard]] std::vector<Match> match_local_map(const LocalMap& map, TrackedFrame& frame) const;
  void seek_consensus(const std::vector<PoseObservation>& observations, const Pose& predicted,
                      std::uint32_t seed, PoseRefinement& refined, TrackedFrame& frame,
                      FrameRecord& record) const;
  [[nodiscard]] std::vector<PoseObservation> observations_of(const LocalMap& map, const TrackedFrame& frame,
                                                             const std::vector<Match>& matches) const;
  [[nodiscard]] PoseRefinement refine(const LocalMap& map, const TrackedFrame& frame,
                                      const std::vector<Match>& matches, double start_gate,
                                      FrameRecord& record) const;
  [[nodiscard]] double start_gate(const TrackedFrame& frame) const;
  [[nodiscard]] std::vector<int> local_points(const LocalMap& map, const TrackedFrame& frame) const;

  Camera camera_;
  Config config_;
  std::vector<double> scales_;
  CameraPath path_;
};

}  // namespace stillpoint
