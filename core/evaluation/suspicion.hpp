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

/// The scale, when it explains more than half of the absolute error, is off one by more than 3 % and surely
/// so (8 poses, 4 standard errors): one sentence.
[[nodiscard]] std::string scale_sentence(const TrajectoryEvaluation& evaluation);

/// That the estimate's scale changes on the way: motions of a third of it each, multiplied by a scale of
/// their own, leave less than 60 % of the error that one scale leaves, and the last one's is 10 % off the
/// first one's: one sentence.
[[nodiscard]] std::string scale_drift_sentence(const std::vector<MatchedPose>& matched);

/// The time by which the estimate's stamps are off, when it explains more than half of the absolute error and
/// is 5 ms or more: one sentence. Searched for, as estimate_time_offset does, only where the errors lie along
/// the truth's velocity.
/// @param truth,estimate what `evaluation` was made of, in seconds of one clock
[[nodiscard]] std::string clock_sentence(const Trajectory& truth, const Trajectory& estimate,
                                         const TrajectoryEvaluation& evaluation);

/// That poses repeat the one before to the last digit while the truth moves, three or more: one sentence.
[[nodiscard]] std::string held_pose_sentence(const std::vector<MatchedPose>& matched);

/// That the alignment's rotation is not told by the positions, which lie too near a line for how much they
/// miss after the best scale, where all orientations are off by one angle that this explains: one sentence.
[[nodiscard]] std::string open_rotation_sentence(const TrajectoryEvaluation& evaluation);

/// That all orientations are off by one large angle though positions tell the alignment's rotation: one
/// sentence.
[[nodiscard]] std::string turned_axes_sentence(const TrajectoryEvaluation& evaluation);

/// That the estimate misses, after the best scale, by nearly as much as one that never moves: one sentence.
[[nodiscard]] std::string no_better_than_rest_sentence(const TrajectoryEvaluation& evaluation);

/// A doubt about figures.
struct Doubt {
  Suspicion::Of of = Suspicion::Of::estimate;
  std::string sentence;
};

/// What makes the figures of another program's estimate doubtful, of all the above but the open rotation,
/// which doubts one figure alone. What another doubt explains is not told as well.
/// @param truth,estimate what `evaluation` was made of, in seconds of one clock
/// @param align by which it was made
/// @param command what stands before its options: "stillpoint evaluate " where another command tells them
[[nodiscard]] std::vector<Doubt> doubts_about(const Trajectory& truth, const Trajectory& estimate,
                                              const TrajectoryEvaluation& evaluation, AlignBy align,
                                              const std::string& command);

}  // namespace stillpoint
