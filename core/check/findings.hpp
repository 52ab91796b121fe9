#pragma once

#include <atomic>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/trajectory.hpp"

namespace stillpoint {

class FrameSource;

/// Something about an input that cannot be right, or that was mended on opening.
struct Finding {
  std::string
      about;  ///< "stamps", "depth", "masks", "camera", "truth", "images", "estimate", "odometry", "time"
  std::string sentence;  ///< what was found, with its figure, and the switch that mends it where there is one
};

void to_json(nlohmann::json& json, const Finding& finding);

/// What can be said of a sequence from its lists and a sample of its images: all that was told on opening,
/// parts that are of no use, gaps in time, and images that repeat the one before.
[[nodiscard]] std::vector<Finding> check_frames(const FrameSource& source);

/// Of that what was not told on opening already.
[[nodiscard]] std::vector<Finding> look_over(const FrameSource& source);

/// What can be said of ground truth beside poses that are independent of it: a convention, a constant motion
/// between two bodies, a scale, a shift in time, each by how much better the alternative fits; of another
/// program's estimate all that `evaluate` doubts (doubts_about).
/// @param estimate_may_err false where the estimate is our own, whose convention is known
/// @param baseline_m m, of the stereo pair whose depth our estimate went by; 0: a depth sensor's
[[nodiscard]] std::vector<Finding> check_truth(const Trajectory& truth, const Trajectory& estimate,
                                               bool estimate_may_err, double baseline_m = 0.0);

/// The odometry's (method `none`) poses of the sequence's first frames, and what they say: few frames that
/// can be tracked, and, where there is ground truth, check_truth.
/// @param frames at most
/// @param stop when it turns true, nothing is found
[[nodiscard]] std::vector<Finding> check_odometry(const FrameSource& source, int frames,
                                                  const std::atomic<bool>* stop = nullptr);

/// Whether depth lies on colour: by the shift under which outlines in depth (its near sides) lie nearest to
/// edges in brightness, over frames spread over the sequence. Told from 6 px on, where that takes a tenth off
/// the mean distance.
[[nodiscard]] std::vector<Finding> check_registration(const FrameSource& source);

/// Whether measured depth goes with parallax: points that stand still are triangulated between two frames
/// (essential matrix, no depth used), which tells their depth but for one factor a pair. Told where another
/// reading of the depth images fits much better (the distance from the camera's centre, disparity or inverse
/// depth), or where the two have nothing to do with each other. A wrong scale shows in neither: it cancels.
[[nodiscard]] std::vector<Finding> check_parallax(const FrameSource& source);

/// The known camera under which the odometry's reprojections miss least, when they miss by 1.5 % more under
/// the one that is used, and surely so (4 standard errors over the frames). Cameras that are alike
/// (freiburg1's and freiburg2's) cannot be told apart in so few frames, nor any where people walk about.
/// @param frames at most; they are read once and tracked under each camera, two cameras side by side
/// @param stop when it turns true, nothing is found
[[nodiscard]] std::vector<Finding> check_camera(const FrameSource& source, int frames,
                                                const std::atomic<bool>* stop = nullptr);

/// A shift of the truth's clock under which motions fit better: seconds to add to the truth's stamps, and
/// both fits.
struct TimeShift {
  double seconds = 0.0;
  double as_is_m = 0.0, mended_m = 0.0;  ///< RMSE of motions over a few frames, a degree counting 1.7 cm
};

/// The best shift as far as offset_search lets, half a second at most, when it leaves less than 70 % of the
/// error over the same motions, is 15 ms or more, is not at the end of the search, and holds without any
/// fifth of the stretch: over a short one, where odometry slips once, some shift always fits better.
[[nodiscard]] std::optional<TimeShift> find_time_shift(const Trajectory& truth, const Trajectory& estimate);

}  // namespace stillpoint
