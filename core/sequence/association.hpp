#pragma once

#include <cstddef>
#include <vector>

#include "core/geometry/trajectory.hpp"

namespace stillpoint {

/// A frame's true pose is interpolated between poses that are no farther apart than this.
inline constexpr double kTruthMaxGap = 0.05;  // s

/// Indices into two lists of stamps that belong together.
struct AssociatedPair {
  std::size_t first = 0, second = 0;
  double difference = 0.0;  ///< s, stamp of first less stamp of second
};

/// Greedy one-to-one association in time, as the TUM benchmark means it: of all pairs strictly closer than
/// `tolerance` seconds the closest is taken first, and neither of its ends again. Ties go to the earlier
/// stamps.
/// @param first,second stamps in s, each in increasing order
/// @return the pairs in order of time
[[nodiscard]] std::vector<AssociatedPair> associate(const std::vector<double>& first,
                                                    const std::vector<double>& second,
                                                    double tolerance = kAssociationTolerance);

}  // namespace stillpoint
