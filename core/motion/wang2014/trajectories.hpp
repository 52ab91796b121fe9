#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/motion/alcantarilla2012/flow_test.hpp"
#include "core/motion/residual_motion.hpp"
#include "core/motion/rgbd_view.hpp"
#include "core/motion/wang2014/wang2014_config.hpp"

namespace stillpoint {

// Point trajectories of method `wang2014`: a grid of points that dense flow follows from frame to frame.

/// A frame as the method keeps it.
struct TrajectoryFrame {
  int index = -1;
  double timestamp = 0.0;  ///< s
  RgbdView view;           ///< at half size: small pixels
  cv::Mat gray;            ///< CV_8UC1, small
  PixelRays rays;          ///< of the small pixels
};

/// Where a trajectory was in a frame.
struct TrajectoryPoint {
  cv::Point2f small;                              ///< small px
  Eigen::Vector2f ray = Eigen::Vector2f::Zero();  ///< x and y of (x, y, 1)
  float z = 0.0F;                                 ///< m; 0 = not measured
  [[nodiscard]] bool measured() const { return z > 0.0F; }
  [[nodiscard]] Eigen::Vector3f position() const { return {ray.x() * z, ray.y() * z, z}; }  ///< m
};

/// Newest last; never empty.
using PointTrajectory = std::vector<TrajectoryPoint>;

/// All trajectories that reach the newest frame.
struct TrajectorySet {
  std::vector<double> timestamps;  ///< s, of the window's frames, newest last
  std::vector<PointTrajectory> all;

  /// The point of a trajectory so many frames before the newest; null where it did not exist yet.
  [[nodiscard]] const TrajectoryPoint* back(std::size_t trajectory, int frames) const {
    const PointTrajectory& one = all[trajectory];
    return frames < static_cast<int>(one.size()) ? &one[one.size() - 1 - static_cast<std::size_t>(frames)]
                                                 : nullptr;
  }
};

/// Follows each to the new frame, as far as flow leads there and back within
/// forward_backward_px + forward_backward_share · |flow|, drops what is older than the window, and begins one
/// in each cell of the grid without. @param flow to `here` from the frame of `before`'s newest points; null
/// where there is none, and all begin anew
[[nodiscard]] TrajectorySet advanced(const TrajectorySet& before, const FlowPair* flow,
                                     const TrajectoryFrame& here, const Wang2014Config& config);

/// Those that are long enough, measured now and near enough, at most most_trajectories, evenly chosen in
/// their order.
[[nodiscard]] std::vector<int> clustered_trajectories(const TrajectorySet& set, const Wang2014Config& config);

/// Flow at a place between small pixels, bilinear.
[[nodiscard]] cv::Vec2f flow_between(const cv::Mat& flow, const cv::Point2f& at);

}  // namespace stillpoint
