#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/evaluation/trajectory_metrics.hpp"

namespace stillpoint {

// What questions about an estimate go by: motions over about a second, and how near is near.

inline constexpr double kWorthAWord = 0.02;  // m, combined: what fits as well leaves no doubt
inline constexpr double kShareOfMotion =
    0.4;  // of the true motions, that a reading which tells them may err by
inline constexpr std::size_t kFewestPoses = 8;  // below, anything fits

/// Pairs of poses some time apart: (i, i + step).
struct PosePairs {
  std::size_t step = 1, count = 0;
};

/// About a second apart, or half of the poses where there is less.
[[nodiscard]] inline PosePairs pairs_of(const std::vector<MatchedPose>& matched) {
  if (matched.size() < 2) return {};
  std::size_t step = 1;
  while (step < matched.size() / 2 && matched[step].timestamp - matched[0].timestamp < 1.0) ++step;
  return {step, matched.size() - step};
}

/// From the one to the other, in the first one's coordinates.
[[nodiscard]] inline Pose motion_between(const Pose& a, const Pose& b) { return a.inverse() * b; }

/// How the lengths of pairs `begin` to `end` fit, the latter not among them.
struct LengthFit {
  double along = 0.0, squares = 0.0, moved = 0.0;  // m², of estimate and truth, of the estimate, of the truth

  LengthFit(const std::vector<MatchedPose>& matched, std::size_t step, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d a = motion_between(matched[i].truth, matched[i + step].truth).translation(),
                            b = motion_between(matched[i].estimate, matched[i + step].estimate).translation();
      along += a.dot(b), squares += b.squaredNorm(), moved += a.squaredNorm();
    }
  }
  /// By what the estimate's lengths fit best; 0 where they point the other way.
  [[nodiscard]] double scale() const { return squares > 0 ? std::max(0.0, along / squares) : 1.0; }
  /// Sum of the squares that this scale leaves, m².
  [[nodiscard]] double left() const {
    return std::max(0.0, moved - 2.0 * scale() * along + scale() * scale() * squares);
  }
};

}  // namespace stillpoint
