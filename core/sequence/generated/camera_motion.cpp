#include "core/sequence/generated/camera_motion.hpp"

#include <cmath>

namespace stillpoint::generated {
namespace {

constexpr double kDegree = M_PI / 180;  // rad

/// Camera axes (x right, y down, z ahead) for someone who looks from one point at another.
Pose look_at(const Eigen::Vector3d& position, const Eigen::Vector3d& target) {
  Pose pose = Pose::Identity();
  const Eigen::Vector3d ahead = (target - position).normalized();
  const Eigen::Vector3d right = ahead.cross(Eigen::Vector3d::UnitZ()).normalized();
  pose.linear().col(0) = right;
  pose.linear().col(1) = ahead.cross(right);
  pose.linear().col(2) = ahead;
  pose.translation() = position;
  return pose;
}

struct Amplitudes {
  double shift, turn;  // m, rad: of the slow drift beside the main movement
};

Amplitudes drift_of(Handling handling) {
  switch (handling) {
    case Handling::kStatic:
      return {0.004, 0.35 * kDegree};
    case Handling::kXyz:
      return {0.02, 1.6 * kDegree};
    case Handling::kRpy:
      return {0.03, 1.0 * kDegree};
    case Handling::kHalfsphere:
      return {0.03, 2.0 * kDegree};
    case Handling::kSweep:
      return {0.04, 2.2 * kDegree};
    case Handling::kShaken:
      return {0.03, 1.0 * kDegree};
  }
  return {0, 0};
}

/// 0 for most of a first half of the period, 1 for most of the other, and from one to the other within
/// `jerk`.
double to_and_fro(double seconds, double period, double jerk) {
  const double phase = seconds - period * std::floor(seconds / period);
  const auto smooth = [](double t) { return t <= 0 ? 0.0 : t >= 1 ? 1.0 : t * t * (3 - 2 * t); };
  return smooth((phase - 0.5 * period) / jerk) - smooth((phase - period) / jerk + 1);
}

}  // namespace

CameraMotion::CameraMotion(const CameraPlan& plan, unsigned seed) : plan_(plan) {
  Dice dice(hash(seed, 0xCA3Eu));
  const Amplitudes drift = drift_of(plan.handling);
  for (std::size_t i = 0; i < 3; ++i) {
    shift_[i] = Wander(dice, drift.shift, 0.05, 0.35, 3);
    turn_[i] = Wander(dice, drift.turn, 0.08, 0.5, 3);
    shift_tremor_[i] = Wander(dice, 0.0005, 2, 8, 6);
    turn_tremor_[i] = Wander(dice, 0.06 * kDegree, 2, 8, 6);
    start_[i] = dice.between(0, 2 * M_PI);
  }
}

Pose CameraMotion::world_from_camera(double s) const {
  Eigen::Vector3d position = plan_.position, target = plan_.target, turn(0, 0, 0);
  const double e = plan_.extent;
  const auto wave = [&](std::size_t i, double rate) { return std::sin(rate * s + start_[i]); };
  if (plan_.handling == Handling::kXyz) {
    const Eigen::Vector3d by(0.28 * wave(0, 0.95), 0.2 * wave(1, 0.71), 0.16 * wave(2, 1.22));
    position += e * by;
    target += e * by;
  } else if (plan_.handling == Handling::kRpy) {
    turn = e * kDegree * Eigen::Vector3d(13 * wave(0, 1.15), 22 * wave(1, 0.9), 17 * wave(2, 1.35));
  } else if (plan_.handling == Handling::kShaken) {
    // Calm for most of a second, then off to the other side: a turn begins and ends without warning.
    const double aside = 20 * to_and_fro(s + start_[0], 2.4, 0.18) - 10,
                 up = 9 * to_and_fro(s + start_[1], 3.4, 0.15) - 4.5;
    const double roll = 14 * to_and_fro(s + start_[2], 4.6, 0.2) - 7;
    turn = e * kDegree * Eigen::Vector3d(up + 2 * wave(0, 1.15), aside + 3 * wave(1, 0.9), roll);
    position += e * Eigen::Vector3d(0.12 * wave(2, 0.8), 0.05 * wave(1, 0.6), 0.03 * wave(0, 1.1));
  } else if (plan_.handling == Handling::kHalfsphere || plan_.handling == Handling::kSweep) {
    const bool sweep = plan_.handling == Handling::kSweep;
    const Eigen::Vector3d out = position - target;
    const double radius = out.norm(), rest = std::asin(out.z() / radius);
    const double around = e * kDegree * (sweep ? 38 * wave(0, 0.33) : 27 * wave(0, 0.52));
    const double up = rest + e * kDegree * (sweep ? 6 * wave(1, 0.5) : 7 + 10 * wave(1, 0.63));
    const double reach = radius * (1 + e * 0.06 * wave(2, 0.45));
    position = target + reach * Eigen::Vector3d(std::sin(around) * std::cos(up),
                                                -std::cos(around) * std::cos(up), std::sin(up));
  }
  Pose pose = look_at(position, target);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    turn[axis] += turn_[i].at(s) + turn_tremor_[i].at(s);
    pose.translation()[axis] += shift_[i].at(s) + shift_tremor_[i].at(s);
  }
  pose.linear() = pose.linear() * so3_exp(turn);
  return pose;
}

}  // namespace stillpoint::generated
