#pragma once

#include <string>

#include "core/config.hpp"

namespace stillpoint {

/// A change to a run so small that whoever measures would not have thought of it: what a method gains must
/// survive it. The first is none at all.
struct Perturbation {
  int features = 0;     ///< added to features.count
  int seed = 0;         ///< added to run.seed
  int first_frame = 0;  ///< the run begins with
};

/// The `index`-th: features by -10 to +10, the first frame by 0 to 2, and each its own seed; nine differ in
/// features and first frame, more go farther.
[[nodiscard]] Perturbation perturbation(int index);

/// The config under it.
[[nodiscard]] Config perturbed(Config config, const Perturbation& by);

/// "features -10, first frame 2, seed 7", or "as it is".
[[nodiscard]] std::string to_text(const Perturbation& by);

}  // namespace stillpoint
