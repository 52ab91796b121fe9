#pragma once

#include <span>
#include <vector>

#include "core/motion/dai2020/point_graph.hpp"

namespace stillpoint {

// The judgement of method `peng2017`: edges between two frames, without memory.

/// Change of each edge's length from the last frame to this one by its own deviation:
/// (d_t - d_{t-1}) / √(σ_t² + σ_{t-1}²). @param here, last the same points, all measured
[[nodiscard]] std::vector<double> edge_strains(std::span<const PointPair> edges,
                                               std::span<const GraphPoint> here,
                                               std::span<const GraphPoint> last, const SceneFlowNoise& noise);

/// Share of each point's edges that hold, those strained by no more than `cut_sigmas`; NaN of a point without
/// edges.
[[nodiscard]] std::vector<float> held_shares(std::size_t points, std::span<const PointPair> edges,
                                             std::span<const double> strains, double cut_sigmas);

/// Static where more than `least` of the edges hold, dynamic where not, unjudged without edges.
[[nodiscard]] std::vector<PointVerdict> verdicts_by_shares(std::span<const float> shares, double least);

}  // namespace stillpoint
