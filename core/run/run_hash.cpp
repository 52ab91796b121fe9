#include "core/run/run_hash.hpp"

namespace stillpoint {

void RunHash::add(const FrameRecord& r) {
  print_.add(r.index);
  print_.add(static_cast<int>(r.status));
  for (int i = 0; i < 12; ++i) print_.add(r.world_from_camera.matrix()(i % 3, i / 3));
  for (const int figure : {r.features_found, r.features_removed, r.motion_rounds, r.matches, r.inliers,
                           r.map_points, r.map_keyframes, static_cast<int>(r.keyframe)})
    print_.add(figure);
  print_.add(r.mask_share);
}

bool computed_alike(const FrameRecord& a, const FrameRecord& b) {
  RunHash first, second;
  first.add(a);
  second.add(b);
  return first.hex() == second.hex();
}

}  // namespace stillpoint
