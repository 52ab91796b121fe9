#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/geometry/se3.hpp"
#include "core/motion/residual_motion.hpp"
#include "core/motion/wang2014/wang2014_config.hpp"

namespace stillpoint {

// Rigid motions of sets of points, and clusters that move as one, for method `wang2014`.

/// The rigid motion that brings `from` nearest to `to` in the sense of least squares (Kabsch); nothing of
/// fewer than three pairs. @param from, to one pair each, m
[[nodiscard]] std::optional<Pose> rigid_motion(std::span<const Eigen::Vector3f> from,
                                               std::span<const Eigen::Vector3f> to);

/// Which of the pairs a motion (here from last) explains: |M| within `sigmas` of its deviation along M.
[[nodiscard]] std::vector<std::uint8_t> explained_by(const Pose& motion, std::span<const ScenePair> pairs,
                                                     const SceneFlowNoise& noise, double sigmas);

/// The motion that explains the most pairs, by samples of three, solved again from all that it explains.
struct RigidFit {
  bool found = false;  ///< three pairs or more, and a sample that is not in a line
  Pose motion = Pose::Identity();
  int explained = 0;
};
[[nodiscard]] RigidFit fit_rigid(std::span<const ScenePair> pairs, const SceneFlowNoise& noise, double sigmas,
                                 int samples, std::uint32_t seed);

/// The clusters' motions, and which became one.
struct MergedClusters {
  std::vector<RigidFit> motions;  ///< one a cluster that went in
  std::vector<int> merged;        ///< of each cluster, the first that it is one with
};

/// Joins clusters each of whose motions explains more than merge_share of the other's pairs. @param pairs,
/// cluster one each; cluster -1 = none
[[nodiscard]] MergedClusters merge_clusters(std::span<const ScenePair> pairs, std::span<const int> cluster,
                                            int clusters, const SceneFlowNoise& noise,
                                            const Wang2014Config& config);

/// Share of a cluster's pairs that a motion explains; 0 of an empty one.
[[nodiscard]] double explained_share(const Pose& motion, std::span<const ScenePair> pairs,
                                     std::span<const int> cluster, int which, const SceneFlowNoise& noise,
                                     double sigmas);

}  // namespace stillpoint
