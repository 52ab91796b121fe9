#pragma once

#include <string>
#include <vector>

#include "core/odometry/dso/dso_window.hpp"

namespace stillpoint {

/// A point as tracking uses it: a pixel of the newest keyframe, with all that the window knows of its depth.
struct CoarsePoint {
  double u = 0.0, v = 0.0;  ///< px of the level
  double inverse_depth = 0.0;
  float brightness = 0.0F;  ///< grey levels, of the keyframe
  float weight = 1.0F;      ///< by the motion method, in the point's host
  int id = -1;              ///< map point; -1 at coarse levels, where several are one
};

/// What frames are tracked against: the newest keyframe, with all of the window's points projected into it.
struct CoarseReference {
  int keyframe = -1, frame_index = 0;
  Pose camera_from_world = Pose::Identity();
  Affine affine;
  Vector6d velocity = Vector6d::Zero();
  std::vector<std::vector<CoarsePoint>> levels;  ///< finest first
};

[[nodiscard]] CoarseReference make_coarse_reference(const DsoWindow& window, const Camera& camera);

/// How a frame was tracked.
struct CoarseAlignment {
  std::string failure;  ///< empty when it is to be believed
  Pose frame_from_reference = Pose::Identity();
  Affine affine;                    ///< the frame's
  double rmse = 0.0;                ///< grey levels, robust, of the finest level; what starts are compared by
  int tries = 0;                    ///< starts tried
  int iterations = 0;               ///< accepted steps, of the start that won
  double cutoff = 0.0;              ///< grey levels, as it ended
  std::vector<CoarsePoint> points;  ///< the finest level's that are in view, u and v in the frame
  std::vector<float> residuals;     ///< one each, grey levels
  int inliers = 0;                  ///< within the cutoff
  double shift_px = 0.0,
         flow_px = 0.0;  ///< RMS flow a coordinate, at 640x480: by translation alone, and whole
};

/// DSO's tracking: brightness of the reference's points in the frame over pose, gain and offset, Levenberg-
/// Marquardt, coarse to fine, from each start until one is good enough.
/// @param weight of the frame's pixels, as in TrackerFrame
/// @param starts frame_from_reference, the likeliest first
/// @param usual rmse of the frame before; infinite where there is none
[[nodiscard]] CoarseAlignment track_coarse(const CoarseReference& reference, const DsoImage& frame,
                                           const TrackerFrame& looked, const std::vector<Pose>& starts,
                                           const Affine& affine, double usual, const DsoConfig& config);

/// Constant, double, half and no motion, the keyframe's pose, then 26 small turns about the first.
/// @param predicted, last camera_from_world; @param reference likewise
[[nodiscard]] std::vector<Pose> dso_starts(const Pose& predicted, const Pose& last, const Pose& reference,
                                           double turn);

}  // namespace stillpoint
