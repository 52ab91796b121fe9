#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/geometry/pose_convention.hpp"

namespace stillpoint {

/// How well motions agree over a second, or over half of the poses where there is less.
struct MotionFit {
  int pairs = 0;
  double scale = 1.0;          ///< by which the estimate's lengths are multiplied
  double delta_s = 0.0;        ///< median time between the poses of a pair
  double translation_m = 0.0;  ///< RMSE
  double rotation_deg = 0.0;   ///< RMSE
  double moved_m = 0.0;        ///< the true motions themselves, combined: what an estimate at rest errs by

  /// Metres, a degree counting as it displaces what is one metre away.
  [[nodiscard]] double combined_m() const;
  /// Whether it errs by so little of the true motions that it is theirs.
  [[nodiscard]] bool tells_motions() const;
};

/// @param scale_is_free the estimate's lengths are multiplied by what fits best, for programs of one camera
[[nodiscard]] MotionFit motion_fit(const std::vector<MatchedPose>& matched, bool scale_is_free = false);

/// A way to read one of two trajectories under which they fit far better than as they stand.
struct Suspicion {
  enum class Of { truth, estimate, either };
  Of of = Of::truth;                                       ///< either: the other one would do as well
  PoseConvention convention = PoseConvention::as_written;  ///< as_written: a constant rotation instead
  std::optional<Pose>
      body_from_camera;  ///< the constant motion between what the truth follows and the camera
  MotionFit as_is, mended;

  /// One sentence: what fits, by how much better, and the switch that mends it where there is one.
  [[nodiscard]] std::string sentence() const;
};

/// The reading of truth or estimate that lets both fit best, when it leaves less than 40 % of an error that
/// is worth a word (2 cm and more, a degree counting 1.7 cm). Conventions are tried one by one; if none does,
/// the constant rotation and lever arm between two bodies that move as one (hand-eye calibration), where
/// poses last long enough (motions of 0.8 s) and each fifth of the motions is told by the others as well.
/// @param estimate_may_err false where the estimate is our own, whose convention is known; otherwise, where
///                         nothing is found, all of this is asked up to the estimate's scale
[[nodiscard]] std::optional<Suspicion> suspect_convention(const std::vector<MatchedPose>& matched,
                                                          bool estimate_may_err);

}  // namespace stillpoint
