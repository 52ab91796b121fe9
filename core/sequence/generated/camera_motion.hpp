#pragma once

#include <array>

#include "core/geometry/se3.hpp"
#include "core/sequence/generated/random.hpp"

namespace stillpoint::generated {

/// The benchmark's ways of holding a camera.
enum class Handling {
  kStatic,      ///< held still, as well as a hand can
  kXyz,         ///< moved to and fro along three axes, hardly turned
  kRpy,         ///< turned about three axes in place
  kHalfsphere,  ///< carried on an arc about the scene, looking at its middle
  kSweep,       ///< carried slowly round the desk
  kShaken,      ///< turned in place by jerks, up to some 170 degrees a second
};

struct CameraPlan {
  Handling handling = Handling::kStatic;
  Eigen::Vector3d position{0, 0, 1.45};  ///< rest position, world, m
  Eigen::Vector3d target{0, 2.4, 0.95};  ///< what it looks at, world, m
  double extent = 1;                     ///< factor on the handling's amplitudes
};

/// A smooth pose for every time, with the tremor of hands (2 to 8 Hz).
class CameraMotion {
 public:
  CameraMotion(const CameraPlan& plan, unsigned seed);

  [[nodiscard]] Pose world_from_camera(double seconds) const;

 private:
  CameraPlan plan_;
  std::array<Wander, 3> shift_, turn_;  ///< slow, m and rad
  std::array<Wander, 3> shift_tremor_, turn_tremor_;
  std::array<double, 3> start_{};  ///< phases of the main movement
};

}  // namespace stillpoint::generated
