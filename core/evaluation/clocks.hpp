#pragma once

#include <string>
#include <vector>

#include "core/geometry/trajectory.hpp"
#include "core/geometry/trajectory_file.hpp"
#include "core/sequence/association.hpp"
#include "core/sequence/stamps.hpp"

namespace stillpoint {

/// What is known of the clocks of two trajectories that are to be compared.
struct ClockOptions {
  std::string truth_name = "the truth", estimate_name = "the estimate";  ///< for messages
  bool truth_in_seconds = false;  ///< a sequence has converted its stamps already
  std::vector<double>
      frame_stamps;  ///< s, of the sequence's frames, which a numbered estimate counts; empty = unknown
  double frame_rate = kFrameNumberRate;        ///< Hz, of frame numbers
  double tolerance_s = kAssociationTolerance;  ///< poses belong together when closer than this
  double estimate_offset_s = 0.0;              ///< added to the estimate's stamps once they are seconds
};

/// Converts the stamps of both to seconds of one clock, by unit_of and unit_beside, and tells each conversion
/// in a sentence. Whole numbers may be frames or seconds: what lets more poses meet is chosen, then what
/// makes both last equally long, then frames. Numbers of a sequence's frames count from 0, or from 1 where
/// only that lets all meet.
[[nodiscard]] std::vector<std::string> settle_clocks(Trajectory& truth, Trajectory& estimate,
                                                     const ClockOptions& options);

/// Gives rows without stamps (KITTI's), which are told apart by their number alone, the stamps of frames: of
/// the first ones, a row each. Where there is about a row for every k-th frame, they are laid on these if
/// motions are then the truth's, by less than half of the error that they have on the first; rows beyond the
/// last frame are left out.
/// @param frame_stamps of all frames that the rows may stand for, in increasing order
/// @param truth on the clock of these; empty where there is none
/// @returns what was done and why, one sentence; empty for a file that has stamps
[[nodiscard]] std::string lay_rows_on_frames(TrajectoryFile& file, const std::vector<double>& frame_stamps,
                                             const Trajectory& truth, const std::string& name);

/// Why two trajectories in seconds meet nowhere, as far as that can be told: another origin of the clock and
/// by how much, or frame numbers against times. One sentence that names the way on.
[[nodiscard]] std::string why_apart(const Trajectory& truth, const Trajectory& estimate,
                                    const ClockOptions& options);

}  // namespace stillpoint
