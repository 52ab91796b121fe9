#pragma once

#include "core/sequence/generated/random.hpp"
#include "core/sequence/generated/scene.hpp"

namespace stillpoint::generated {

/// Puts furniture into a scene. Positions are world, m; yaw in radians.
class Furnisher {
 public:
  Furnisher(Scene& scene, Dice& dice);

  /// A picture with a tint, repeated `repeats` times a metre (0 = stretched over each face).
  std::uint16_t surface(Picture picture, float repeats = 0, const Vector3f& tint = {1, 1, 1},
                        bool glows = false);
  /// A plain colour, BGR 0 to 255.
  std::uint16_t plain(float blue, float green, float red);

  Primitive& box(const Vector3f& centre, const Vector3f& size, double yaw, std::uint16_t surface);
  Primitive& rod(const Vector3f& from, const Vector3f& to, float radius, std::uint16_t surface);
  Primitive& cylinder(const Vector3f& from, const Vector3f& to, float radius, std::uint16_t surface);
  Primitive& ellipsoid(const Vector3f& centre, const Vector3f& radii, double yaw, std::uint16_t surface);
  /// A flat picture hung on a wall: `facing` is the wall's outward yaw (−90° = towards −y).
  void hang(const Vector3f& centre, float width, float height, double facing, std::uint16_t surface);

  void room();
  void desk(const Vector2f& centre, const Vector2f& size);
  void partition();
  void monitor(const Vector3f& foot, double yaw, bool on);
  void chair(const Vector2f& seat, double yaw);
  void shelf(const Vector2f& centre, double yaw, int boards);
  void plant(const Vector3f& foot, float height);
  void mug(const Vector3f& foot, const Vector3f& tint);
  void books_lying(const Vector3f& foot, int count);
  void desk_things();
  void robot_arm(const Vector3f& foot);

  Dice& dice() { return dice_; }

 private:
  void spines(const Vector3f& from, const Vector3f& along, double yaw, float length, float tallest);

  Scene& scene_;
  Dice& dice_;
  std::uint16_t metal_, white_, black_, wood_, dark_wood_, cable_;
};

constexpr float kDeskHeight = 0.74f;  // m, of the table tops

}  // namespace stillpoint::generated
