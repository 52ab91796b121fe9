#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "core/geometry/trajectory.hpp"

namespace stillpoint {

/// By how much the estimate's clock is off, as far as the two paths tell.
struct TimeOffset {
  double offset_s = 0.0;       ///< to be added to the estimate's stamps
  double rmse_before_m = 0.0;  ///< ATE with truth interpolated at the stamps as they are
  double rmse_after_m = 0.0;   ///< … and with the offset added
};

/// How far two clocks may be laid apart so that every offset is measured by the same poses: over a short
/// stretch, offsets that lose the poses with the large errors would look like the better ones.
struct OffsetSearch {
  double reach_s = 0.0;            ///< to both sides
  std::vector<std::size_t> poses;  ///< those of the estimate that stay inside the truth all the way
};

/// The reach that leaves two thirds of the poses which lie inside the truth now, `most_s` at most.
[[nodiscard]] OffsetSearch offset_search(const Trajectory& truth, const Trajectory& estimate, double most_s);

/// Whether an offset is one of the whole stretch: without any fifth of it, one is found that differs by less
/// than `apart_s` and a quarter of the offset. What one disturbed part tells is no clock.
/// @param samples of the stretch, in order @param find the offset by those samples alone
[[nodiscard]] bool holds_without_any_part(
    double offset_s, double apart_s, const std::vector<std::size_t>& samples,
    const std::function<std::optional<double>(const std::vector<std::size_t>&)>& find);

/// The offset under which the ATE against interpolated truth is least, to 1e-7 s, searched as far as
/// offset_search lets, half a second at most.
/// @return nothing where fewer than 10 poses, or less than half of them, stay inside the truth; where the
/// path tells nothing (within 20 ms of the best the ATE changes by less than a hundredth); where the least
/// lies at the end of the search; or where it does not hold without any part (30 ms)
[[nodiscard]] std::optional<TimeOffset> estimate_time_offset(const Trajectory& truth,
                                                             const Trajectory& estimate);

}  // namespace stillpoint
