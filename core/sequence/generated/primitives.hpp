#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/sequence/generated/texture.hpp"

namespace stillpoint::generated {

using Eigen::Matrix3f;
using Eigen::Vector2f;
using Eigen::Vector3f;

/// Nothing is seen nearer than this.
inline constexpr float kNear = 0.05f;  // m

/// What a face of a primitive is covered with.
struct Surface {
  Picture picture = Picture::kPlain;
  Vector3f tint{1, 1, 1};  ///< BGR factors on the picture
  float repeats = 0;       ///< repeats of the picture a metre; 0 = stretched once over the face
  Vector2f offset{0, 0};   ///< added to (u, v), in repeats
  bool glows = false;      ///< shown as it is, without shading: screens, lamps, windows
};

enum class Shape : std::uint8_t {
  kBox,        ///< [-1, 1]³
  kRoom,       ///< the same, seen from inside
  kEllipsoid,  ///< the unit sphere
  kCylinder,   ///< radius 1 about z, z in [-1, 1]
  kCone,       ///< two spheres on the z axis and the cone round them; metres
};

/// A solid: a canonical shape under an affine map.
///
/// Faces: boxes -x +x -y +y -z +z; cylinders side, caps; others one.
struct Primitive {
  Shape shape = Shape::kBox;
  bool moving = false;  ///< belongs to the moving mask
  float dropout = 0;    ///< 0 to 1: how much of it a depth camera fails to see (dark, shiny, transparent)
  Vector3f centre{0, 0, 0};                            ///< world, m
  Matrix3f local_from_world = Matrix3f::Identity();    ///< local = local_from_world * (world - centre)
  Vector3f half{1, 1, 1};                              ///< metres a local unit; scales pictures
  float radius_start = 0, radius_end = 0, length = 0;  ///< cones: spheres at z = 0 and z = length, m
  std::array<std::uint16_t, 6> surface{};              ///< indices into Scene::surfaces

  /// Whether each face has one normal.
  [[nodiscard]] bool is_flat() const { return shape == Shape::kBox || shape == Shape::kRoom; }
};

/// Axes as columns from a rotation about z (radians).
[[nodiscard]] Matrix3f turned(double yaw);

[[nodiscard]] Primitive make_box(const Vector3f& centre, const Vector3f& half, const Matrix3f& axes,
                                 std::uint16_t surface);
[[nodiscard]] Primitive make_ellipsoid(const Vector3f& centre, const Vector3f& radii, const Matrix3f& axes,
                                       std::uint16_t surface);
/// An upright or lying cylinder between two points.
[[nodiscard]] Primitive make_cylinder(const Vector3f& from, const Vector3f& to, float radius,
                                      std::uint16_t surface);
/// A rounded cone between two points. `front` is where its picture's middle faces; the shape is thinner along
/// it by the factor `flat`.
[[nodiscard]] Primitive make_cone(const Vector3f& from, float radius_from, const Vector3f& to,
                                  float radius_to, std::uint16_t surface, const Vector3f& front = {0, -1, 0},
                                  float flat = 1);

/// A primitive as one camera sees it at one instant: local = origin + t * rotation * (x, y, 1), with t the
/// depth in m.
struct SeenPrimitive {
  Matrix3f rotation;
  Vector3f origin;
  float cone_offset = 0, cone_slope = 0;  ///< of the cone's side: rho = offset - slope * z
  float radius_start = 0, radius_end = 0, length = 0;
  Shape shape = Shape::kBox;
};

[[nodiscard]] SeenPrimitive see(const Primitive& primitive, const Matrix3f& world_from_camera,
                                const Vector3f& position);

/// Unit normal of a flat primitive's face, outward (inward, for rooms), world.
[[nodiscard]] Vector3f flat_normal(const Primitive& primitive, int face);

/// How a picture covers a face: at (u, v) from -1 to 1 over the face it shows 0.5 + repeats * (u, v) * half,
/// in repeats of the picture.
struct PictureFit {
  Vector2f half;  ///< m from the middle of the face to its edges; 1 where the picture is stretched over it
  float repeats;  ///< a metre; 0.5 where it is stretched
  float texels_per_metre;
};
[[nodiscard]] PictureFit fit_picture(const Primitive& primitive, const Surface& surface,
                                     const Texture& picture, int face);

}  // namespace stillpoint::generated
