#pragma once

#include <limits>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "core/motion/dai2020/dai2020_config.hpp"
#include "core/motion/dai2020/point_graph.hpp"

namespace stillpoint {

// The graph of method `dai2020`, which lives on from frame to frame: points, and edges that remember how long
// they were.

/// What an edge remembers of its length, and whether it is cut.
struct EdgeMemory {
  double weight = 0.0;         ///< 1/m²: sum of 1/σ² over its life
  double weighted = 0.0;       ///< 1/m: sum of d/σ²
  int life = 0;                ///< frames in which it was measured
  std::uint32_t strained = 0;  ///< bit k: strained in the measured frame k before the last one
  int calm = 0;                ///< frames in a row that it was calm
  bool cut = false;
  int cut_at = -1;  ///< frame in which it was cut; -1 while it is not
  double strain =
      std::numeric_limits<double>::quiet_NaN();  ///< (d - d̂) / σ when measured last; NaN before that

  /// d̂, m; of an edge that was measured.
  [[nodiscard]] double mean() const { return weighted / weight; }

  /// Tests a length against the mean of those before, σ² = σ_d² + 1/weight, cuts and mends, and takes it into
  /// the mean. The first one is taken alone.
  void measure(const EdgeLength& now, int frame, const Dai2020Config& config);
};

/// A point that is followed from frame to frame.
struct TrackedPoint {
  int id = -1;
  int group = -1;  ///< of the last frame; -1 = none
  PointVerdict verdict = PointVerdict::kUnjudged;
};

struct TrackedEdge {
  PointPair points{};  ///< indices, not ids
  EdgeMemory memory;
  bool measured = false;  ///< in this frame
};

struct TrackedGraph {
  std::vector<GraphPoint> seen;      ///< as this frame sees them
  std::vector<TrackedPoint> points;  ///< one each
  std::vector<TrackedEdge> edges;
  int next_id = 0;
  int frames_since_keyframe = 0;
};

/// The graph without the points that are not `kept`, and without their edges.
[[nodiscard]] TrackedGraph without_lost(const TrackedGraph& graph, std::span<const std::uint8_t> kept);

/// Measures every edge both of whose ends are measured.
void measure_edges(TrackedGraph& graph, const SceneFlowNoise& noise, int frame, const Dai2020Config& config);

/// Joins points by edges that are settled and not cut, and judges each: the largest group is static, groups
/// too small undecided, the others dynamic. Points without a settled edge belong to none. @return the groups
PointGroups judge_points(TrackedGraph& graph, const Dai2020Config& config);

/// A keyframe: features with depth that lie off all points become points, and all measured points are
/// triangulated anew. Edges that the graph has not are added; those that it has stay, and live as long as
/// both their ends. @return how many points are new
int extend_graph(TrackedGraph& graph, std::span<const MotionFeature> features, const GraphFrame& here,
                 const Dai2020Config& config);

}  // namespace stillpoint
