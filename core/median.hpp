#pragma once

#include <algorithm>
#include <cstddef>

namespace stillpoint {

/// The middle one of `values` (of an even number the upper of both), which are reordered; 0 of none.
template <typename Values>
[[nodiscard]] typename Values::value_type median_of(Values& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace stillpoint
