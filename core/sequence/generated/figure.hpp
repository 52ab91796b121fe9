#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/sequence/generated/scene.hpp"

namespace stillpoint::generated {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// How a person is built and dressed; surfaces are indices into Scene::surfaces.
struct FigureLook {
  double height = 1.78;  ///< m
  double girth = 1.0;    ///< factor on every radius
  bool long_sleeves = false;
  std::uint16_t shirt = 0, trousers = 0, skin = 0, face = 0, hair = 0, shoes = 0, belt = 0;
};

/// What a hand does: hangs with the arm, or is held at a point.
struct HandGoal {
  double weight = 0;         ///< 0 = swings with the arm, 1 = at the target
  Vector3d target{0, 0, 0};  ///< world, m
};

/// A person at one instant. Angles in radians; side 0 is left.
struct FigureState {
  Vector2d position{0, 0};               ///< of the pelvis over the floor, m
  double heading = 0;                    ///< about z, 0 = along +x
  double stride_phase = 0;               ///< 2 pi a pair of steps
  double stride = 0;                     ///< 0 = stands, 1 = walks at full step
  double sitting = 0;                    ///< 0 = upright, 1 = on a chair
  double lean = 0, sway = 0, twist = 0;  ///< of the torso: forward, to the left, turned left
  double head_turn = 0, head_nod = 0;    ///< relative to the torso: left, down
  std::array<HandGoal, 2> hands;
};

/// Where hands are, so that things can be held.
struct FigureHands {
  std::array<Vector3d, 2> palm;
};

/// Adds the person's primitives, all moving, to the instant; always as many.
FigureHands add_figure(const FigureLook& look, const FigureState& state, Instant& instant);

}  // namespace stillpoint::generated
