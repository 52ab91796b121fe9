#include "core/motion/dai2020/point_graph.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace stillpoint {
namespace {

/// Points by place, so that few are looked at.
class Cells {
 public:
  explicit Cells(double reach) : reach_(static_cast<float>(std::max(1.0, reach))) {}

  void add(int index, const cv::Point2f& at) { points_.push_back({row(at.y), at, index}); }
  void sort() {
    std::stable_sort(points_.begin(), points_.end(), [](const At& a, const At& b) { return a.row < b.row; });
  }
  /// Calls `visit(index, distance)` for what lies within reach.
  template <typename Visit>
  void near(const cv::Point2f& at, const Visit& visit) const {
    auto i = std::lower_bound(points_.begin(), points_.end(), row(at.y) - 1,
                              [](const At& a, int wanted) { return a.row < wanted; });
    for (; i != points_.end() && i->row <= row(at.y) + 1; ++i) {
      const cv::Point2f apart = i->at - at;
      if (std::abs(apart.x) > reach_) continue;
      if (const float distance = std::hypot(apart.x, apart.y); distance <= reach_) visit(i->index, distance);
    }
  }

 private:
  struct At {
    int row;
    cv::Point2f at;
    int index;
  };
  [[nodiscard]] int row(float y) const { return static_cast<int>(std::floor(y / reach_)); }
  float reach_;
  std::vector<At> points_;
};

class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  int root(int i) {
    while (parent(i) != i) i = parent(i) = parent(parent(i));
    return i;
  }
  /// The smaller root stays one, so that the order of edges does not matter.
  void join(int a, int b) {
    a = root(a), b = root(b);
    parent(std::max(a, b)) = std::min(a, b);
  }

 private:
  int& parent(int i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<int> parent_;
};

}  // namespace

GraphFrame make_graph_frame(const Frame& frame, const PixelRays& rays, const FollowRule& rule) {
  GraphFrame made;
  made.index = frame.index;
  made.depth = frame.depth;
  made.rays = rays;
  cv::buildOpticalFlowPyramid(frame.gray, made.pyramid, {rule.window_px, rule.window_px}, rule.levels, false);
  return made;
}

GraphPoint point_at(const cv::Point2f& pixel, const GraphFrame& frame) {
  GraphPoint point;
  point.pixel = pixel;
  point.ray = frame.rays.at(pixel.x, pixel.y);
  point.z = surface_depth(frame.depth, pixel.x, pixel.y);
  return point;
}

std::vector<FollowedPoint> follow_points(const std::vector<cv::Point2f>& points, const GraphFrame& from,
                                         const GraphFrame& to, const FollowRule& rule) {
  std::vector<FollowedPoint> followed(points.size());
  if (points.empty()) return followed;
  std::vector<cv::Point2f> there, back;
  std::vector<std::uint8_t> is_found, is_back;
  const cv::Size window(rule.window_px, rule.window_px);
  cv::calcOpticalFlowPyrLK(from.pyramid, to.pyramid, points, there, is_found, cv::noArray(), window,
                           rule.levels);
  cv::calcOpticalFlowPyrLK(to.pyramid, from.pyramid, there, back, is_back, cv::noArray(), window,
                           rule.levels);
  const cv::Rect2f image({0.0F, 0.0F}, cv::Size2f(to.pyramid.front().size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point2f miss = back[i] - points[i];
    followed[i].followed = is_found[i] != 0 && is_back[i] != 0 && image.contains(there[i]) &&
                           std::hypot(miss.x, miss.y) <= rule.forward_backward_px;
    followed[i].pixel = there[i];
  }
  return followed;
}

EdgeLength edge_length(const GraphPoint& a, const GraphPoint& b, const SceneFlowNoise& noise) {
  const Eigen::Vector3d apart = (a.position() - b.position()).cast<double>();
  const Eigen::Matrix3d covariance =
      (point_covariance(a.ray, a.z, noise) + point_covariance(b.ray, b.z, noise)).cast<double>();
  EdgeLength edge;
  edge.length = apart.norm();
  edge.variance =
      edge.length > 0.0 ? apart.dot(covariance * apart) / apart.squaredNorm() : covariance.trace() / 3.0;
  return edge;
}

std::vector<PointPair> delaunay_edges(std::span<const GraphPoint> points, const cv::Size& size,
                                      const EdgeRule& rule) {
  constexpr int kFirst = 4;  // the triangulation's own vertices come before
  const cv::Rect image({0, 0}, size);
  cv::Subdiv2D subdivision(image);
  std::vector<int> point_of(kFirst, -1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point2f& at = points[i].pixel;
    if (!points[i].measured() || !cv::Rect2f(image).contains(at)) continue;
    const auto vertex = static_cast<std::size_t>(subdivision.insert(at));
    if (vertex >= point_of.size()) point_of.resize(vertex + 1, -1);
    if (point_of[vertex] < 0) point_of[vertex] = static_cast<int>(i);
  }
  std::vector<int> triangles;
  subdivision.getLeadingEdgeList(triangles);
  std::vector<PointPair> edges;
  for (const int first : triangles) {
    int edge = first;
    for (int side = 0; side < 3; ++side) {
      const int a = point_of[static_cast<std::size_t>(std::max(0, subdivision.edgeOrg(edge)))];
      const int b = point_of[static_cast<std::size_t>(std::max(0, subdivision.edgeDst(edge)))];
      edge = subdivision.getEdge(edge, cv::Subdiv2D::NEXT_AROUND_LEFT);
      if (a < 0 || b < 0) continue;
      const GraphPoint &p = points[static_cast<std::size_t>(a)], &q = points[static_cast<std::size_t>(b)];
      const cv::Point2f apart = p.pixel - q.pixel;
      if (std::hypot(apart.x, apart.y) > rule.least_px &&
          (static_cast<double>((p.position() - q.position()).norm()) > rule.most_m ||
           std::abs(static_cast<double>(p.z - q.z)) > rule.most_step_m))
        continue;
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

int PointGroups::largest(bool by_hull_area) const {
  const auto smaller = [by_hull_area](const PointGroup& a, const PointGroup& b) {
    return by_hull_area ? a.hull_area_px2 < b.hull_area_px2 : a.points.size() < b.points.size();
  };
  if (groups.empty()) return -1;
  return static_cast<int>(std::max_element(groups.begin(), groups.end(), smaller) - groups.begin());
}

PointGroups group_points(std::span<const GraphPoint> points, std::span<const PointPair> edges,
                         std::span<const std::uint8_t> known) {
  UnionFind joined(points.size());
  for (const PointPair& edge : edges) joined.join(edge[0], edge[1]);
  PointGroups found;
  found.of_point.assign(points.size(), -1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (known[i] == 0) continue;
    int& group = found.of_point[static_cast<std::size_t>(joined.root(static_cast<int>(i)))];
    if (group < 0) group = static_cast<int>(found.groups.size()), found.groups.emplace_back();
    found.groups[static_cast<std::size_t>(group)].points.push_back(static_cast<int>(i));
  }
  std::fill(found.of_point.begin(), found.of_point.end(), -1);
  for (std::size_t g = 0; g < found.groups.size(); ++g) {
    std::vector<cv::Point2f> pixels, hull;
    for (const int i : found.groups[g].points) {
      found.of_point[static_cast<std::size_t>(i)] = static_cast<int>(g);
      pixels.push_back(points[static_cast<std::size_t>(i)].pixel);
    }
    cv::convexHull(pixels, hull);
    found.groups[g].hull_area_px2 = cv::contourArea(hull);
  }
  return found;
}

std::vector<int> spaced_features(std::span<const MotionFeature> features, std::span<const cv::Point2f> taken,
                                 double spacing_px) {
  const float cell = static_cast<float>(std::max(1.0, spacing_px));
  std::vector<int> chosen;
  // Rows of cells, each with what stands in it so far.
  std::vector<std::vector<cv::Point2f>> rows;
  const auto row_of = [cell](const cv::Point2f& at) { return static_cast<int>(std::max(0.0F, at.y) / cell); };
  const auto take = [&](const cv::Point2f& at) {
    const auto row = static_cast<std::size_t>(row_of(at));
    if (rows.size() <= row) rows.resize(row + 1);
    rows[row].push_back(at);
  };
  for (const cv::Point2f& at : taken) take(at);
  for (std::size_t i = 0; i < features.size(); ++i) {
    const cv::Point2f& at = features[i].pixel;
    bool free = true;
    for (int row = std::max(0, row_of(at) - 1); row <= row_of(at) + 1; ++row)
      if (static_cast<std::size_t>(row) < rows.size())
        for (const cv::Point2f& other : rows[static_cast<std::size_t>(row)])
          free = free && std::hypot(other.x - at.x, other.y - at.y) >= cell;
    if (!free) continue;
    take(at);
    chosen.push_back(static_cast<int>(i));
  }
  return chosen;
}

std::vector<int> nearest_points(std::span<const MotionFeature> features, std::span<const GraphPoint> points,
                                std::span<const PointVerdict> verdicts, double reach_px, double most_step_m) {
  Cells cells(reach_px);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (verdicts[i] != PointVerdict::kUnjudged) cells.add(static_cast<int>(i), points[i].pixel);
  cells.sort();
  std::vector<int> nearest(features.size(), -1);
  for (std::size_t f = 0; f < features.size(); ++f) {
    float least = static_cast<float>(reach_px);
    cells.near(features[f].pixel, [&](int i, float distance) {
      const float z = points[static_cast<std::size_t>(i)].z;
      const bool elsewhere = features[f].depth > 0.0F && z > 0.0F &&
                             static_cast<double>(std::abs(features[f].depth - z)) > most_step_m;
      if (elsewhere || distance > least || (distance == least && nearest[f] >= 0)) return;
      least = distance;
      nearest[f] = i;
    });
  }
  return nearest;
}

}  // namespace stillpoint
