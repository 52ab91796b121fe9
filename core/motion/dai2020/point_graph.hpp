#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/motion/motion_method.hpp"
#include "core/motion/residual_motion.hpp"

namespace stillpoint {

// Points and the distances between neighbours, which are the same whatever a camera does that moves alone:
// what methods `dai2020` and `peng2017` share. (Dai et al., TPAMI 2020.)

/// A frame as points are followed in it.
struct GraphFrame {
  int index = -1;
  std::vector<cv::Mat> pyramid;  ///< as cv::buildOpticalFlowPyramid makes it
  cv::Mat depth;                 ///< CV_32FC1, m
  PixelRays rays;
};

/// How points are followed.
struct FollowRule {
  int window_px = 15;  ///< side of the Lucas-Kanade window
  int levels = 3;      ///< pyramid levels above the image itself
  double forward_backward_px = 1.0;
};

[[nodiscard]] GraphFrame make_graph_frame(const Frame& frame, const PixelRays& rays, const FollowRule& rule);

/// A point of the graph as one frame sees it.
struct GraphPoint {
  cv::Point2f pixel;                              ///< px
  Eigen::Vector2f ray = Eigen::Vector2f::Zero();  ///< x and y of (x, y, 1)
  float z = 0.0F;                                 ///< m; 0 = not measured
  [[nodiscard]] bool measured() const { return z > 0.0F; }
  [[nodiscard]] Eigen::Vector3f position() const { return {ray.x() * z, ray.y() * z, z}; }  ///< m
};

/// What a frame sees at a pixel; not measured where depth is missing, or at an outline.
[[nodiscard]] GraphPoint point_at(const cv::Point2f& pixel, const GraphFrame& frame);

/// Where a point went.
struct FollowedPoint {
  bool followed = false;  ///< there and back again within the limit
  cv::Point2f pixel;      ///< px, when followed
};

[[nodiscard]] std::vector<FollowedPoint> follow_points(const std::vector<cv::Point2f>& points,
                                                       const GraphFrame& from, const GraphFrame& to,
                                                       const FollowRule& rule);

/// The distance of two measured points.
struct EdgeLength {
  double length = 0.0;    ///< m
  double variance = 0.0;  ///< m²: uᵀ (Σ_a + Σ_b) u, u from one to the other
};
[[nodiscard]] EdgeLength edge_length(const GraphPoint& a, const GraphPoint& b, const SceneFlowNoise& noise);

/// Which edges of a triangulation are left out: those longer than `least_px` that are longer than `most_m` or
/// step in depth by more than `most_step_m`. Shorter ones across an outline must exist to be cut.
struct EdgeRule {
  double most_m = 1.0, most_step_m = 0.3, least_px = 60.0;
};

/// Two points by their indices, the smaller first.
using PointPair = std::array<int, 2>;

/// Edges of the Delaunay triangulation of the measured points (cv::Subdiv2D), in ascending order, each once.
/// Points outside the image are left out, as is the second of two at the same place.
[[nodiscard]] std::vector<PointPair> delaunay_edges(std::span<const GraphPoint> points, const cv::Size& size,
                                                    const EdgeRule& rule);

/// Points that hang together.
struct PointGroup {
  std::vector<int> points;     ///< ascending
  double hull_area_px2 = 0.0;  ///< of the points' convex hull in the image
};
struct PointGroups {
  std::vector<int> of_point;  ///< group of each point; -1 = no edge names it
  std::vector<PointGroup> groups;

  /// The group with the most points, or the largest hull; the first of equals; -1 where there is none.
  [[nodiscard]] int largest(bool by_hull_area) const;
};

/// Union-find. @param edges any that join points; @param known one a point: non-zero where it belongs to a
/// group, though of itself alone
[[nodiscard]] PointGroups group_points(std::span<const GraphPoint> points, std::span<const PointPair> edges,
                                       std::span<const std::uint8_t> known);

/// What is held of a point, or of a feature.
enum class PointVerdict : std::uint8_t {
  kUnjudged,  ///< nothing is known of its distances: it stays
  kStatic,
  kUndecided,  ///< belongs to no group large enough: kept out of the pose, not called dynamic
  kDynamic,
};
[[nodiscard]] inline bool is_out(PointVerdict verdict) {
  return verdict == PointVerdict::kUndecided || verdict == PointVerdict::kDynamic;
}

/// Of the features, those that may become points, in their order: none nearer to another, or to one of
/// `taken`, than `spacing_px`.
[[nodiscard]] std::vector<int> spaced_features(std::span<const MotionFeature> features,
                                               std::span<const cv::Point2f> taken, double spacing_px);

/// For each feature the nearest of the judged points within `reach_px` that is not in another depth (where
/// the feature has one); -1 where there is none.
[[nodiscard]] std::vector<int> nearest_points(std::span<const MotionFeature> features,
                                              std::span<const GraphPoint> points,
                                              std::span<const PointVerdict> verdicts, double reach_px,
                                              double most_step_m);

}  // namespace stillpoint
