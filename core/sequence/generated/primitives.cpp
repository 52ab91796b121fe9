#include "core/sequence/generated/primitives.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace stillpoint::generated {
namespace {

constexpr float kPi = 3.14159265f;  // single precision, as all of a primitive is

}  // namespace

Matrix3f turned(double yaw) {
  return Eigen::AngleAxisf(static_cast<float>(yaw), Vector3f::UnitZ()).toRotationMatrix();
}

Primitive make_box(const Vector3f& centre, const Vector3f& half, const Matrix3f& axes,
                   std::uint16_t surface) {
  Primitive p;
  p.centre = centre;
  p.half = half;
  p.local_from_world = half.cwiseInverse().asDiagonal() * axes.transpose();
  p.surface.fill(surface);
  return p;
}

Primitive make_ellipsoid(const Vector3f& centre, const Vector3f& radii, const Matrix3f& axes,
                         std::uint16_t surface) {
  Primitive p = make_box(centre, radii, axes, surface);
  p.shape = Shape::kEllipsoid;
  return p;
}

namespace {

/// Axes with z from one point to another and -y as near to `front` as can be.
Matrix3f axes_along(const Vector3f& from, const Vector3f& to, const Vector3f& front) {
  Matrix3f axes;
  const Vector3f z = (to - from).normalized();
  Vector3f x = z.cross(front);
  if (x.squaredNorm() < 1e-6f) x = z.cross(std::abs(z.x()) < 0.8f ? Vector3f::UnitX() : Vector3f::UnitY());
  x.normalize();
  axes.col(0) = x;
  axes.col(1) = z.cross(x);
  axes.col(2) = z;
  return axes;
}

}  // namespace

Primitive make_cylinder(const Vector3f& from, const Vector3f& to, float radius, std::uint16_t surface) {
  const Vector3f half(radius, radius, (to - from).norm() / 2);
  Primitive p = make_box((from + to) / 2, half, axes_along(from, to, {0, -1, 0}), surface);
  p.shape = Shape::kCylinder;
  return p;
}

Primitive make_cone(const Vector3f& from, float radius_from, const Vector3f& to, float radius_to,
                    std::uint16_t surface, const Vector3f& front, float flat) {
  Primitive p;
  p.shape = Shape::kCone;
  p.centre = from;
  p.local_from_world = Vector3f(1, 1 / flat, 1).asDiagonal() * axes_along(from, to, front).transpose();
  p.length = std::max((to - from).norm(), 1e-4f);
  // One sphere must not swallow the other: the cone would have no side.
  const float limit = 0.95f * p.length;
  p.radius_start = std::min(radius_from, radius_to + limit);
  p.radius_end = std::min(radius_to, radius_from + limit);
  p.surface.fill(surface);
  return p;
}

SeenPrimitive see(const Primitive& p, const Matrix3f& world_from_camera, const Vector3f& position) {
  SeenPrimitive seen;
  seen.shape = p.shape;
  seen.rotation = p.local_from_world * world_from_camera;
  seen.origin = p.local_from_world * (position - p.centre);
  if (p.shape == Shape::kCone) {
    const float sine = (p.radius_start - p.radius_end) / p.length, cosine = std::sqrt(1 - sine * sine);
    seen.cone_offset = p.radius_start / cosine;
    seen.cone_slope = sine / cosine;
    seen.radius_start = p.radius_start, seen.radius_end = p.radius_end, seen.length = p.length;
  }
  return seen;
}

Vector3f flat_normal(const Primitive& p, int face) {
  const float sign = face % 2 == 1 ? 1.0f : -1.0f;
  Vector3f local = Vector3f::Zero();
  local[face / 2] = p.shape == Shape::kRoom ? -sign : sign;
  return (p.local_from_world.transpose() * local).normalized();
}

namespace {

Vector2f half_of_face(const Primitive& p, int face) {
  switch (p.shape) {
    case Shape::kBox:
    case Shape::kRoom:
      return {face / 2 == 0 ? p.half.y() : p.half.x(), face / 2 == 2 ? p.half.y() : p.half.z()};
    case Shape::kCylinder:
      if (face == 1) return {p.half.x(), p.half.x()};
      break;
    case Shape::kCone:
      return {kPi * (0.5f * (p.radius_start + p.radius_end)), 0.5f * p.length};
    case Shape::kEllipsoid:
      break;
  }
  return {kPi * p.half.x(), p.half.z()};
}

}  // namespace

PictureFit fit_picture(const Primitive& p, const Surface& surface, const Texture& picture, int face) {
  const Vector2f half = half_of_face(p, face);
  const auto width = static_cast<float>(picture.width()), height = static_cast<float>(picture.height());
  if (surface.repeats > 0) return {half, surface.repeats, surface.repeats * width};
  return {{1, 1}, 0.5f, std::max(width / (2 * half.x()), height / (2 * half.y()))};
}

}  // namespace stillpoint::generated
