#pragma once

#include <memory>

#include "core/sequence/source.hpp"

namespace stillpoint::testing {

/// A made-up street driven along: what a stereo pair on a car sees, as far as odometry is concerned. Ground,
/// house fronts, parked cars, trees and poles from 4 to 100 m; a car comes the other way. Filmed by the
/// generator's ray caster, at 10 Hz, through a camera like KITTI's (1241x376 px, 0.537 m), 1 m a frame, in a
/// slight curve; poses are exact.
/// @param frames up to 100
/// @param scale of the images' sides: 0.5 is an eighth of the work of matching
[[nodiscard]] std::unique_ptr<FrameSource> make_street(int frames, double scale = 1.0,
                                                       const StereoOptions& stereo = {});

}  // namespace stillpoint::testing
