#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/trajectory.hpp"

namespace stillpoint {

/// Where a quaternion's real part stands.
enum class QuaternionOrder { xyzw, wxyz };

/// A trajectory as a file has it: stamps in whatever unit they are written, poses in whatever convention.
struct TrajectoryFile {
  Trajectory poses;
  QuaternionOrder order = QuaternionOrder::xyzw;  ///< that was read
  bool order_is_named =
      false;               ///< a header or the format says so; otherwise it is the TUM format's, or asked for
  bool has_stamps = true;  ///< false where a row's number stands for its time (KITTI, TartanAir)
  int rows = 0;            ///< that were meant to hold a pose
  int skipped = 0;         ///< of these, rows that hold none; `warnings` tell why
  std::vector<std::string> warnings;
};

/// Reads a trajectory in one of these formats, told by its header and its columns:
/// - TUM: `timestamp tx ty tz qx qy qz qw`;
/// - EuRoC's and TUM-VI's csv: a stamp, a position, a quaternion with w first, then whatever follows;
/// - any table of 8 or more columns whose header names them (`timestamp, x, y, z, qw, qx, qy, qz`, …), in any
///   order; of a ROS message's columns its header's stamp, whole or as seconds and nanoseconds, goes before
///   the time of recording;
/// - TartanAir: tx ty tz qx qy qz qw, no stamps;
/// - KITTI: the 12 numbers of a 3x4 matrix, no stamps; Replica: the 16 of a 4x4 matrix; either behind a stamp
///   or a frame's number, where rows have 13 or 17.
/// Columns are parted by blanks, tabs, commas or semicolons; decimal commas are read where blanks, tabs or
/// semicolons part columns.
///
/// One bad row costs that row: with other columns than the rest, with NaN or infinity (motion capture that
/// lost the body), with a quaternion that is zero or more than 1 % off unit length. Each kind is counted in
/// `warnings`, with its first line. Rows out of order are sorted; of equal stamps the first is kept.
/// @param order overrides what the file says
/// @throws InputError for a file that cannot be read or holds no poses, one of which half of the rows or more
/// are
///         bad for another reason than NaN, and one of which most poses repeat a stamp.
[[nodiscard]] TrajectoryFile read_trajectory_file(const std::string& path,
                                                  std::optional<QuaternionOrder> order = {});

/// The same of a text that is at hand; `path` names it in messages.
[[nodiscard]] TrajectoryFile read_trajectory_text(const std::string& path, std::string_view text,
                                                  std::optional<QuaternionOrder> order = {});

}  // namespace stillpoint
