#pragma once

#include <vector>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/odometry/local_map.hpp"

namespace stillpoint {

/// A local bundle adjustment, cut out of the map: METHOD.md §2.4. Plain data, so that it can be solved beside
/// tracking.
struct BundleProblem {
  struct View {
    int keyframe = kNone;
    Pose camera_from_world = Pose::Identity();
    bool fixed = false;
  };
  struct Point {
    int point = kNone;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m
  };
  struct Edge {
    int view = 0, point = 0;                          ///< indices into the vectors below
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< px, undistorted
    double depth = 0.0;                               ///< m; 0 = none
    double sigma_px = 1.0;
    double static_weight = 1.0;  ///< weight of its squares, before Huber's bound: FeatureSet::static_weight
  };
  struct Carried {
    int point = kNone, view = 0;
    Eigen::Vector3d position_in_camera = Eigen::Vector3d::Zero();  ///< m
  };
  std::vector<View> views;
  std::vector<Point> points;     ///< seen by two views or more
  std::vector<Carried> carried;  ///< seen by one alone: they hold nothing, and go along with it
  std::vector<Edge> edges;
};

struct BundleSolution {
  BundleProblem problem;                      ///< views and points moved to where they fit best
  std::vector<std::uint8_t> outlier;          ///< one an edge, by χ² at the end
  double initial_rms_px = 0.0, rms_px = 0.0;  ///< of all edges before, of the inliers after
  int iterations = 0;                         ///< successful Levenberg-Marquardt steps
  bool usable = false;  ///< false: nothing to adjust, or the solver failed; the map stays as it is
};

/// The keyframe, its most covisible neighbours, the points they see, and as fixed views the other keyframes
/// that see those points.
[[nodiscard]] BundleProblem make_bundle_problem(const LocalMap& map, int keyframe, const Config& config);

/// Minimises the robust reprojection error over free views and points (Levenberg-Marquardt, points by Schur
/// complement), first with all edges under Huber's loss, then without the outliers. Deterministic.
[[nodiscard]] BundleSolution solve_bundle(BundleProblem problem, const Camera& camera,
                                          const BundleConfig& config, double depth_weight);

/// Carries a solution back: poses, points, and outlying observations taken away. What has left the map
/// meanwhile is passed over.
void apply_bundle(const BundleSolution& solution, LocalMap& map);

}  // namespace stillpoint
