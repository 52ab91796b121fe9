#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose_convention.hpp"
#include "core/geometry/trajectory_file.hpp"
#include "core/run/records_file.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

// A run that another program made, as far as it left files: laid onto a sequence's frames it is looked at,
// measured and compared like one of ours. outside_run.md tells the files.

/// Where it lies and how it is to be read.
struct OutsideRunFiles {
  std::string name;                             ///< what it is called
  std::string where;                            ///< a trajectory, or a folder of one with masks and features
  std::optional<QuaternionOrder> quaternion{};  ///< where no header tells
  PoseConvention convention = PoseConvention::as_written;
  double time_offset_s = 0.0;  ///< added to its stamps
};

/// "NAME=FILE", or a file alone, which is called by its own name.
/// @throws InputError for a text without a file
[[nodiscard]] OutsideRunFiles outside_run_argument(const std::string& text);

/// Lays it onto the sequence's frames: a frame has the pose nearest in time, closer than 0.02 s, or none and
/// is lost; poses keep their own stamps in the trajectory, which is what is measured. What of its files is
/// odd is told in `warnings`.
/// @param between called after each frame whose mask or features were read; what it throws ends the reading
/// @returns a run with RecordedRun::outside set, without keyframes and map
/// @throws InputError in one sentence where there is no trajectory, or one that meets no frame
[[nodiscard]] RecordedRun read_outside_run(const FrameSource& source, const SequenceOrigin& origin,
                                           const OutsideRunFiles& files, std::vector<std::string>& warnings,
                                           const std::function<void(const FrameRecord&)>& between = {});

/// Sets of a record of such a run what is known of it: a pose, features where there are any, and a mask.
void tell_parts_of_outside(FrameRecord& record, bool mask);

/// Writes it as a run's folder, which opens like any other.
/// @param folder made by prepare_run_folder
/// @throws InputError when it cannot be written
void write_outside_run(const std::string& folder, const RecordedRun& run, const FrameSource& source);

}  // namespace stillpoint
