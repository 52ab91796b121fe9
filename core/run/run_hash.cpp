#include "core/run/run_hash.hpp"

#include <cmath>

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

bool part_ways(const FrameRecords& a, const FrameRecords& b, std::size_t frame) {
  constexpr double kMostApart = 0.02;           // m a frame
  constexpr double kMostTurned = M_PI / 180.0;  // rad a frame
  if (a[frame].estimated != b[frame].estimated) return true;
  if (frame == 0 || !a[frame].estimated || !a[frame - 1].estimated || !b[frame - 1].estimated) return false;
  const auto motion = [frame](const FrameRecords& run) -> Pose {
    return run[frame - 1].world_from_camera.inverse() * run[frame].world_from_camera;
  };
  const Pose off = motion(a).inverse() * motion(b);
  return off.translation().norm() > kMostApart || Eigen::AngleAxisd(off.linear()).angle() > kMostTurned;
}

}  // namespace stillpoint
