#pragma once

#include <array>
#include <vector>

#include "core/geometry/trajectory.hpp"

namespace stillpoint {

/// A trajectory number by number over time, as it is plotted. Where poses are missing (a step more than four
/// times the median one) a NaN stands between, so that no line is drawn across.
struct PoseSeries {
  std::vector<double> time;                     ///< s
  std::array<std::vector<double>, 3> position;  ///< m: x, y, z
  std::array<std::vector<double>, 3> angle;     ///< degrees: roll about x, pitch about y, yaw about z
  std::vector<double> speed;                    ///< m/s, from the pose before; NaN for the first
};

/// Angles are those of R = Rz(yaw) Ry(pitch) Rx(roll), as evo has them, turned on past ±180° rather than
/// jumping. @param start s, taken off every stamp
[[nodiscard]] PoseSeries pose_series(const Trajectory& trajectory, double start = 0.0);

/// The first series less the second at the same moments, where both have a pose; angles within ±180°.
/// @pre both of the same stamps
[[nodiscard]] PoseSeries difference(const PoseSeries& series, const PoseSeries& reference);

}  // namespace stillpoint
