#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/sequence/generated/camera_motion.hpp"
#include "core/sequence/generated/scene.hpp"

namespace stillpoint::generated {

/// A kind of sequence, ready to be filmed: the room, how the camera is held, and who does what when.
struct Act {
  Scene scene;
  CameraPlan camera;
  double exposure = 0.012;  ///< s, of colour
  /// Adds all that can move, as it is at a time in seconds; const and safe from several threads.
  std::function<void(double seconds, Instant& instant)> play;
};

/// @param seconds how long people must have something to do.
/// @throws InputError naming the kinds for one that is not known.
[[nodiscard]] Act make_act(std::string_view kind, unsigned seed, double seconds);

[[nodiscard]] const std::vector<std::string>& act_kinds();
/// Beside them, harder ones that no set of standard sequences holds.
[[nodiscard]] const std::vector<std::string>& hard_act_kinds();

}  // namespace stillpoint::generated
