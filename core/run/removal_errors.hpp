#pragma once

#include <vector>

#include "core/odometry/frame_record.hpp"

namespace stillpoint {

struct TrajectoryEvaluation;

/// Errors of one frame's step from the pose before, against the truth: translational, m. Solved with three
/// masks from the same map by the run's own solver, weights included, so that they tell what the mask did and
/// nothing of how poses are solved. NaN where it was not, or cannot be, solved.
struct RemovalError {
  int frame = 0;
  double with_removal_m = 0.0;
  double without_removal_m = 0.0;
  double oracle_m = 0.0;  ///< with the true mask
  double widened = 0.0;  ///< the position's largest standard deviation, as many times as with nothing removed
  bool hurt = false;     ///< removal made it worse by more than the noise of such steps
  bool helped = false;   ///< … better by more than that
};

/// Did removal help? One entry a frame that was checked (run.check_removal) and whose pose and the one before
/// are known from the truth; by frame. Removal hurt where the step is worse with it than without by more than
/// 1 mm and by more than 3 standard deviations (robust) of that difference over the run; it helped where the
/// step is better by as much.
[[nodiscard]] std::vector<RemovalError> removal_errors(const FrameRecords& records,
                                                       const TrajectoryEvaluation& evaluation);

}  // namespace stillpoint
