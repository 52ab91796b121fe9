#include "core/run/repeats.hpp"

#include <fmt/format.h>

namespace stillpoint {

Perturbation perturbation(int index) {
  constexpr int kFirstFrames = 3, kStep = 10;  // features: what ORB finds scatters by as much
  // 0, -1, 1, -2, 2, …
  const int round = index / kFirstFrames, steps = round % 2 == 0 ? round / 2 : -(round + 1) / 2;
  return {kStep * steps, index, index % kFirstFrames};
}

Config perturbed(Config config, const Perturbation& by) {
  set_parameter(config, fmt::format("features.count={}", config.features.count + by.features));
  set_parameter(config, fmt::format("run.seed={}", config.run.seed + by.seed));
  return config;
}

std::string to_text(const Perturbation& by) {
  if (by.features == 0 && by.seed == 0 && by.first_frame == 0) return "as it is";
  return fmt::format("features {:+}, first frame {}, seed {:+}", by.features, by.first_frame, by.seed);
}

}  // namespace stillpoint
