#pragma once

#include <optional>

#include "core/geometry/trajectory.hpp"

namespace stillpoint {

/// By how much the estimate's clock is off, as far as the two paths tell.
struct TimeOffset {
  double offset_s = 0.0;       ///< to be added to the estimate's stamps
  double rmse_before_m = 0.0;  ///< ATE with truth interpolated at the stamps as they are
  double rmse_after_m = 0.0;   ///< … and with the offset added
};

/// The offset under which the ATE against interpolated truth is least, to 1e-7 s, searched within half a
/// second.
/// @return nothing where fewer than 10 poses meet the truth, or where the path tells nothing: within 20 ms of
/// the best the ATE changes by less than a hundredth
[[nodiscard]] std::optional<TimeOffset> estimate_time_offset(const Trajectory& truth,
                                                             const Trajectory& estimate);

}  // namespace stillpoint
