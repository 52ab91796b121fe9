#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/run/run_sequence.hpp"

namespace stillpoint {

// A run's map as PLY text, which any mesh viewer opens. World coordinates, metres.

/// Map points in the colours they were seen in.
/// @param normals one a point, zero where none is known; empty: the file has no normals
/// @param keyframes whose centres are added, in orange
[[nodiscard]] std::string map_ply(const std::vector<SavedPoint>& points,
                                  const std::vector<Eigen::Vector3f>& normals,
                                  const std::vector<SavedKeyframe>& keyframes);

/// Keyframes as the pyramids their camera sees, each five vertices with the frame's index, four faces and
/// eight edges; as deep as suits the way they went.
[[nodiscard]] std::string keyframes_ply(const std::vector<SavedKeyframe>& keyframes, const Camera& camera);

}  // namespace stillpoint
