#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/motion/stage_log.hpp"

namespace stillpoint {

struct FrameView;
struct RunView;

// One point of the scene in every picture of a pair of frames, without GL or ImGui. Pixels are OpenCV's: the
// middle of pixel (i, j) is (i, j).

/// By what a point came to its place in another picture.
enum class WarpedBy {
  kItself,      ///< the picture shows that very pixel
  kDepth,       ///< its measured depth and the camera's motion
  kHomography,  ///< where there is no depth or no pose: as if it lay on the homography's plane
};

struct WarpedPoint {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  WarpedBy by = WarpedBy::kItself;
};

/// What is known of a pair of frames by which points are carried between its pictures.
struct PairGeometry {
  Camera camera;
  cv::Mat target_depth, reference_depth;      ///< CV_32FC1, m, 0 = none; empty where there is none
  std::optional<Pose> reference_from_target;  ///< the camera's motion, where both poses were estimated
  std::optional<Pose> world_from_target;      ///< … where the target's was
  std::optional<cv::Matx33d> forward,
      backward;          ///< the motion method's, where it has any: target from reference, and the other way
  int small_factor = 1;  ///< full-size pixels a side of a small one
};

/// @param run the run `view` is of: its records hold the poses
[[nodiscard]] PairGeometry pair_geometry(const FrameView& view, const RunView& run, const Camera& camera);

/// Where a picture shows the scene point that the target has at `target` px; nothing where that is not known,
/// as behind the camera or before there is a pair. The place may lie outside the picture.
[[nodiscard]] std::optional<WarpedPoint> scene_point_in(const PairGeometry& pair, FrameSpace space,
                                                        const Eigen::Vector2d& target);

/// Where the target has the scene point that a picture shows at `pixel`: the way back.
[[nodiscard]] std::optional<WarpedPoint> target_point(const PairGeometry& pair, FrameSpace space,
                                                      const Eigen::Vector2d& pixel);

/// The measured depth (m) at a pixel; nothing outside the image or where there is no measurement.
[[nodiscard]] std::optional<double> depth_at_pixel(const cv::Mat& depth, const Eigen::Vector2d& pixel);

/// The point (m) in the target's camera that a target pixel shows; nothing without depth.
[[nodiscard]] std::optional<Eigen::Vector3d> point_in_camera(const PairGeometry& pair,
                                                             const Eigen::Vector2d& target);

}  // namespace stillpoint
