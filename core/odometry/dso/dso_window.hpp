#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/odometry/dso/dso_config.hpp"
#include "core/odometry/dso/dso_image.hpp"

namespace stillpoint {

/// A keyframe of the window.
struct DsoFrame {
  int keyframe = -1;  ///< id in the map
  int frame_index = 0;
  Pose camera_from_world = Pose::Identity();
  Affine affine;
  Vector6d velocity = Vector6d::Zero();  ///< of the camera, a second: rolling shutter is undone by it
  std::shared_ptr<const DsoImage> image;
  cv::Mat weight;       ///< as in TrackerFrame
  int points_made = 0;  ///< in it, in all
  double outlier_energy =
      0.0;  ///< a residual of more (sum over the pattern, grey levels squared) is an outlier
};

/// A point of the window: a pixel of its host keyframe, with eight pixels' brightness, and its inverse depth.
struct DsoPoint {
  int id = -1;                        ///< map point
  int host = -1;                      ///< keyframe id
  double u = 0.0, v = 0.0;            ///< px, rectified
  double inverse_depth = 0.0;         ///< 1/m
  double sensed_inverse_depth = 0.0;  ///< 1/m, what the sensor measured
  std::array<float, 8> brightness{};  ///< grey levels, of the pattern in the host
  std::array<float, 8> softness{};    ///< weights by gradient
  float static_weight = 1.0F;         ///< by the motion method, in the host
  int seen = 0;                       ///< good residuals, at the end of the last optimisation
};

/// Where a pixel of one view lies in another, rolling shutters of both undone.
class DsoTransfer {
 public:
  DsoTransfer(const Camera& camera, const Pose& target_from_host, const Vector6d& host_velocity,
              const Vector6d& target_velocity);

  struct Place {
    double x = 0.0, y = 0.0;  ///< px, in the target
    Eigen::Vector3d in_host, in_target;
  };
  /// Nothing where the point lies behind the target or close before it.
  [[nodiscard]] std::optional<Place> operator()(double u, double v, double inverse_depth) const;

 private:
  [[nodiscard]] double after_middle(double row) const { return camera_.row_time(row); }
  const Camera& camera_;
  Pose target_from_host_;
  Vector6d host_velocity_, target_velocity_;
  bool rolls_;
};

/// What an optimisation did.
struct DsoOptimisation {
  int iterations = 0;                          ///< steps taken
  double rmse_before = 0.0, rmse_after = 0.0;  ///< grey levels a pixel, of the good residuals
  int residuals = 0, outliers = 0;
};

/// How one point looks in one keyframe of the window.
struct DsoResidual {
  int point = 0, frame = 0;  ///< indices into the window's vectors
  double x = 0.0, y = 0.0;   ///< px, where the frame shows it
  float mean = 0.0F;         ///< grey levels, signed, over the pattern
  bool good = false;         ///< no outlier
};

/// DSO's sliding window: keyframes and points, solved together. A value.
///
/// Without marginalisation: what leaves the window leaves nothing behind, and the oldest keyframe is held
/// fixed. Sensed depth holds the scale, by a Gaussian prior on each inverse depth.
class DsoWindow {
 public:
  std::vector<DsoFrame> frames;  ///< oldest first
  std::vector<DsoPoint> points;

  [[nodiscard]] int index_of(int keyframe) const;  ///< into frames; -1 where it has left

  /// Gauss-Newton over poses, brightness and inverse depths, with the points' Schur complement; as published
  /// damped, and a step that makes it worse is undone. Outliers are found anew in each step.
  DsoOptimisation optimise(const Camera& camera, const DsoConfig& config, int threads);

  /// Takes out points whose host has left, or which no keyframe sees well that should. @returns how many
  int drop_lost_points();

  /// Keyframes to leave the window before the next one comes, by DSO's rules: indices into frames, ascending.
  [[nodiscard]] std::vector<int> to_leave(const DsoConfig& config) const;
  void drop_frame(int index);

  /// All residuals as they stand.
  [[nodiscard]] std::vector<DsoResidual> residuals(const Camera& camera, const DsoConfig& config) const;
};

/// A new point's pattern. Nothing where the pattern leaves the image.
[[nodiscard]] std::optional<DsoPoint> make_dso_point(const DsoFrame& host, int x, int y, double depth_m,
                                                     const DsoConfig& config);

}  // namespace stillpoint
