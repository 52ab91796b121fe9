#pragma once

#include <string>
#include <vector>

#include "core/evaluation/suspicion.hpp"

namespace stillpoint {

// What makes figures doubtful. Each sentence is empty where there is nothing to say.

/// The scale, when it explains more than half of the absolute error, is off one by more than 3 % and surely
/// so (8 poses, 4 standard errors): one sentence.
[[nodiscard]] std::string scale_sentence(const TrajectoryEvaluation& evaluation);
/// What gives an odometry's lengths their scale, as a question after that sentence. @param baseline_m of the
/// stereo pair whose depth it went by; 0: a depth sensor's
[[nodiscard]] std::string scale_question(const TrajectoryEvaluation& evaluation, double baseline_m);

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
