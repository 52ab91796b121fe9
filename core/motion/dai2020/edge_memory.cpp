#include "core/motion/dai2020/edge_memory.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

namespace stillpoint {

void EdgeMemory::measure(const EdgeLength& now, int frame, const Dai2020Config& config) {
  if (life > 0) {
    strain = (now.length - mean()) / std::sqrt(now.variance + 1.0 / weight);
    const std::uint32_t window = ~std::uint32_t{0} >> (32 - config.cut_window);
    strained = (strained << 1U | (std::abs(strain) > config.cut_sigmas ? 1U : 0U)) & window;
    calm = std::abs(strain) < config.mend_sigmas ? calm + 1 : 0;
    if (!cut && std::popcount(strained) >= config.cut_count) {
      cut = true;
      cut_at = frame;
      calm = 0;
    } else if (cut && calm >= config.mend_frames) {
      cut = false;
      cut_at = -1;
      strained = 0;
    }
  }
  weight += 1.0 / now.variance;
  weighted += now.length / now.variance;
  ++life;
}

TrackedGraph without_lost(const TrackedGraph& graph, std::span<const std::uint8_t> kept) {
  TrackedGraph left;
  left.next_id = graph.next_id;
  left.frames_since_keyframe = graph.frames_since_keyframe;
  std::vector<int> moved(graph.points.size(), -1);
  for (std::size_t i = 0; i < graph.points.size(); ++i) {
    if (kept[i] == 0) continue;
    moved[i] = static_cast<int>(left.points.size());
    left.points.push_back(graph.points[i]);
    left.seen.push_back(graph.seen[i]);
  }
  for (TrackedEdge edge : graph.edges) {
    for (int& end : edge.points) end = moved[static_cast<std::size_t>(end)];
    if (edge.points[0] >= 0 && edge.points[1] >= 0) left.edges.push_back(edge);
  }
  return left;
}

void measure_edges(TrackedGraph& graph, const SceneFlowNoise& noise, int frame, const Dai2020Config& config) {
  for (TrackedEdge& edge : graph.edges) {
    const GraphPoint &a = graph.seen[static_cast<std::size_t>(edge.points[0])],
                     &b = graph.seen[static_cast<std::size_t>(edge.points[1])];
    edge.measured = a.measured() && b.measured();
    if (edge.measured) edge.memory.measure(edge_length(a, b, noise), frame, config);
  }
}

PointGroups judge_points(TrackedGraph& graph, const Dai2020Config& config) {
  std::vector<PointPair> joining;
  std::vector<std::uint8_t> known(graph.points.size(), 0);
  for (const TrackedEdge& edge : graph.edges) {
    if (edge.memory.life < config.settle_frames) continue;
    for (const int end : edge.points) known[static_cast<std::size_t>(end)] = 1;
    if (!edge.memory.cut) joining.push_back(edge.points);
  }
  PointGroups groups = group_points(graph.seen, joining, known);
  const int still = groups.largest(config.group_by == "hull_area");
  for (std::size_t i = 0; i < graph.points.size(); ++i) {
    TrackedPoint& point = graph.points[i];
    point.group = groups.of_point[i];
    if (point.group < 0) {
      point.verdict = PointVerdict::kUnjudged;
      continue;
    }
    const std::size_t size = groups.groups[static_cast<std::size_t>(point.group)].points.size();
    if (size < static_cast<std::size_t>(config.least_group))
      point.verdict = PointVerdict::kUndecided;
    else
      point.verdict = point.group == still ? PointVerdict::kStatic : PointVerdict::kDynamic;
  }
  return groups;
}

int extend_graph(TrackedGraph& graph, std::span<const MotionFeature> features, const GraphFrame& here,
                 const Dai2020Config& config) {
  std::vector<cv::Point2f> taken;
  for (const GraphPoint& point : graph.seen) taken.push_back(point.pixel);
  int added = 0;
  for (const int f : spaced_features(features, taken, config.spacing_px)) {
    const GraphPoint seen = point_at(features[static_cast<std::size_t>(f)].pixel, here);
    if (!seen.measured()) continue;
    graph.seen.push_back(seen);
    graph.points.push_back({graph.next_id++, -1, PointVerdict::kUnjudged});
    ++added;
  }
  std::set<PointPair> known;
  for (const TrackedEdge& edge : graph.edges) known.insert(edge.points);
  for (const PointPair& pair : delaunay_edges(graph.seen, here.pyramid.front().size(), config.edges())) {
    if (known.contains(pair)) continue;
    TrackedEdge edge;
    edge.points = pair;
    graph.edges.push_back(edge);
  }
  graph.frames_since_keyframe = 0;
  return added;
}

}  // namespace stillpoint
