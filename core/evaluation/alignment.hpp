#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/geometry/se3.hpp"

namespace stillpoint {

/// The rigid motion that lays an estimate over the truth.
struct Alignment {
  Pose truth_from_estimate = Pose::Identity();
  bool degenerate = false;  ///< positions alone do not fix the rotation (fewer than 3 poses, or all on one
                            ///< line or point); what they leave open was taken from the orientations
};

/// Least-squares rigid alignment (no scale) of positions: minimises Σ ‖truth_i - A estimate_i‖² over SE(3),
/// after Umeyama (1991). Degenerate positions are aligned as well as they can be, the freedom left settled by
/// the cameras' orientations.
/// @param estimate,truth corresponding poses, of one length; none gives the identity
[[nodiscard]] Alignment align(const std::vector<Pose>& estimate, const std::vector<Pose>& truth);

/// The same of poses that lie elsewhere. @param estimate,truth give each of `count` poses
using PoseAt = std::function<const Pose&(std::size_t)>;
[[nodiscard]] Alignment align(std::size_t count, const PoseAt& estimate, const PoseAt& truth);

}  // namespace stillpoint
