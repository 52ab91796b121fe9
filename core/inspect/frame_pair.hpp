#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"

namespace stillpoint {

struct FrameView;

// Any two frames of a run held against each other. Pixels are OpenCV's: the middle of pixel (i, j) is (i, j).

/// A map point that both frames found.
struct PairedFeature {
  int map_point = 0;
  int here = 0, other = 0;  ///< its feature in each frame's record
  Eigen::Vector2d pixel_here = Eigen::Vector2d::Zero(), pixel_other = Eigen::Vector2d::Zero();
  bool inlier = false;  ///< it agrees with both frames' poses
  /// Where `here` shows what the other frame measured there, by that frame's depth and both poses: what
  /// stands still is found at this place. Nothing without depth or poses, or behind the camera.
  std::optional<Eigen::Vector2d> expected{};

  /// px from where it is expected to where it is; nothing where nothing is expected.
  [[nodiscard]] std::optional<double> error() const;
};

/// Two frames of a run, by the map points they share.
struct FramePair {
  std::vector<PairedFeature> features;  ///< in the order of the first frame's features
  int only_here = 0, only_other = 0;    ///< matched features whose map point the other frame did not find
  std::optional<Pose> here_from_other;  ///< the camera's motion, where both poses were estimated
  std::optional<double> baseline_m;     ///< its length
  std::optional<double> rotation_deg;   ///< its angle
  std::vector<double> errors;           ///< px, of all that have one, ascending

  /// The middle one of `errors`; nothing where there are none.
  [[nodiscard]] std::optional<double> median_error() const;
};

/// @pre both frames have records with their features, else nothing is paired
[[nodiscard]] FramePair pair_frames(const FrameView& here, const FrameView& other, const Camera& camera);

/// The places in one frame at which a point may be that another shows at `pixel`, from 0.2 m before the other
/// camera to infinity: the epipolar line, bent by the lens, as far as it lies within `margin_px` of the
/// image. Nearest first.
/// @param to_from the camera's motion, from the frame of `pixel` to the one whose pixels are returned
[[nodiscard]] std::vector<Eigen::Vector2d> epipolar_curve(const Camera& camera, const Pose& to_from,
                                                          const Eigen::Vector2d& pixel,
                                                          double margin_px = 40.0);

/// Where one frame shows the point that another shows at `pixel`, `depth_m` before its camera; nothing behind
/// the camera.
[[nodiscard]] std::optional<Eigen::Vector2d> pixel_at_depth(const Camera& camera, const Pose& to_from,
                                                            const Eigen::Vector2d& pixel, double depth_m);

}  // namespace stillpoint
