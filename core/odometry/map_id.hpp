#pragma once

namespace stillpoint {

// Keyframes, map points and frames go by numbers of their own, from 0.

inline constexpr int kNone = -1;  ///< no keyframe, no map point

}  // namespace stillpoint
