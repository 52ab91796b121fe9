#pragma once

#include <string>

namespace stillpoint {

/// A numeric parameter and the values it is given.
struct SweepRange {
  std::string parameter;  ///< `section.name`
  double low = 0.0, high = 0.0;
  int steps = 7;  ///< values from low to high, both among them
  bool operator==(const SweepRange&) const = default;
};

}  // namespace stillpoint
