#include "core/sequence/generated/primitives.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace stillpoint::generated {
namespace {

constexpr float kPi = 3.14159265f;

/// atan2 to about 0.01 rad: picture coordinates need no better, and it runs for every sample on a limb.
float quick_atan2(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float q = std::min(ax, ay) / (std::max(ax, ay) + 1e-20f);
  float a = q * (kPi / 4 + 0.273f * (1 - q));
  if (ay > ax) a = kPi / 2 - a;
  if (x < 0) a = kPi - a;
  return y < 0 ? -a : a;
}

bool keep(float t, int face, Hit& hit) {
  if (!(t > kNear && t < hit.depth)) return false;
  hit = {t, face};
  return true;
}

bool meet_box(const Vector3f& o, const Vector3f& d, bool from_inside, Hit& hit) {
  float enter = -1e9f, leave = 1e9f;
  int enter_face = 0, leave_face = 0;
  for (int i = 0; i < 3; ++i) {
    const float inverse = 1.0f / d[i];
    const float down = (-1.0f - o[i]) * inverse, up = (1.0f - o[i]) * inverse;
    const bool rising = inverse > 0;  // also right when d is a zero of either sign
    const float first = rising ? down : up, second = rising ? up : down;
    if (first > enter) enter = first, enter_face = 2 * i + (rising ? 0 : 1);
    if (second < leave) leave = second, leave_face = 2 * i + (rising ? 1 : 0);
  }
  if (from_inside) return keep(leave, leave_face, hit);
  return enter < leave && keep(enter, enter_face, hit);
}

/// Entry into the sphere of radius r at height z.
bool meet_sphere(const Vector3f& o, const Vector3f& d, float z, float r, Hit& hit) {
  const float oz = o.z() - z;
  const float a = d.squaredNorm(), b = o.x() * d.x() + o.y() * d.y() + oz * d.z();
  const float c = o.x() * o.x() + o.y() * o.y() + oz * oz - r * r;
  const float root = b * b - a * c;
  return root > 0 && keep((-b - std::sqrt(root)) / a, 0, hit);
}

bool meet_cylinder(const Vector3f& o, const Vector3f& d, Hit& hit) {
  const float a = d.x() * d.x() + d.y() * d.y(), b = o.x() * d.x() + o.y() * d.y();
  const float c = o.x() * o.x() + o.y() * o.y() - 1.0f;
  const float root = b * b - a * c;
  if (root > 0 && a > 0) {
    const float t = (-b - std::sqrt(root)) / a;
    if (std::abs(o.z() + t * d.z()) <= 1.0f) return keep(t, 0, hit);
  }
  if (d.z() == 0) return false;
  const float t = ((d.z() < 0 ? 1.0f : -1.0f) - o.z()) / d.z();
  const float x = o.x() + t * d.x(), y = o.y() + t * d.y();
  return x * x + y * y <= 1.0f && keep(t, 1, hit);
}

bool meet_cone(const SeenPrimitive& p, const Vector3f& o, const Vector3f& d, Hit& hit) {
  // The side: rho² = (offset - slope z)², valid where the touching sphere's centre lies on the axis segment.
  const float k = p.cone_offset - p.cone_slope * o.z(), dk = p.cone_slope * d.z();
  const float a = d.x() * d.x() + d.y() * d.y() - dk * dk;
  const float b = o.x() * d.x() + o.y() * d.y() + dk * k;
  const float c = o.x() * o.x() + o.y() * o.y() - k * k;
  const float root = b * b - a * c;
  bool found = false;
  if (root > 0 && a != 0) {
    const float s = std::sqrt(root);
    for (const float t : {(-b - s) / a, (-b + s) / a}) {
      const float rho = k - t * dk, centre = o.z() + t * d.z() - rho * p.cone_slope;
      if (rho >= 0 && centre >= 0 && centre <= p.length) {
        found = keep(t, 0, hit) || found;
        if (a > 0) return found;
      }
      if (a > 0) break;  // the second root is where the ray leaves
    }
  }
  const bool start = meet_sphere(o, d, 0, p.radius_start, hit);
  const bool end = meet_sphere(o, d, p.length, p.radius_end, hit);
  return found || start || end;
}

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

bool intersect(const SeenPrimitive& p, const Vector3f& ray, Hit& hit) {
  const Vector3f d = p.rotation * ray;
  switch (p.shape) {
    case Shape::kBox:
      return meet_box(p.origin, d, false, hit);
    case Shape::kRoom:
      return meet_box(p.origin, d, true, hit);
    case Shape::kEllipsoid:
      return meet_sphere(p.origin, d, 0, 1, hit);
    case Shape::kCylinder:
      return meet_cylinder(p.origin, d, hit);
    case Shape::kCone:
      return meet_cone(p, p.origin, d, hit);
  }
  return false;
}

namespace {

SurfacePoint describe_box(const Primitive& p, const Vector3f& local, int face) {
  const int axis = face / 2;
  const float sign = face % 2 == 1 ? 1.0f : -1.0f;
  SurfacePoint point{Vector3f::Zero(), {0, 0}, 0};
  point.normal[axis] = p.shape == Shape::kRoom ? -sign : sign;
  // As someone looking at the face sees it: u to the right, v downwards, from -1 to 1.
  if (axis == 0) point.uv = {sign * local.y(), -local.z()};
  if (axis == 1) point.uv = {-sign * local.x(), -local.z()};
  if (axis == 2) point.uv = {local.x(), -sign * local.y()};
  if (p.shape == Shape::kRoom) point.uv.x() = -point.uv.x();
  return point;
}

}  // namespace

SurfacePoint describe(const Primitive& p, const Surface& surface, const Texture& picture,
                      const Vector3f& local, int face) {
  SurfacePoint point{local, {0, 0}, 0};
  Vector2f half(1, 1);  // metres from the middle of the picture to its edges
  switch (p.shape) {
    case Shape::kBox:
    case Shape::kRoom:
      point = describe_box(p, local, face);
      half = {face / 2 == 0 ? p.half.y() : p.half.x(), face / 2 == 2 ? p.half.y() : p.half.z()};
      break;
    case Shape::kEllipsoid:
      point.uv = {quick_atan2(local.x(), -local.y()) / kPi, -local.z()};
      half = {kPi * p.half.x(), p.half.z()};
      break;
    case Shape::kCylinder:
      if (face == 1) {
        point.normal = {0, 0, local.z()};
        point.uv = {local.x(), -local.y()};
        half = {p.half.x(), p.half.x()};
      } else {
        point.normal.z() = 0;
        point.uv = {quick_atan2(local.x(), -local.y()) / kPi, -local.z()};
        half = {kPi * p.half.x(), p.half.z()};
      }
      break;
    case Shape::kCone: {
      const float rho = std::sqrt(local.x() * local.x() + local.y() * local.y());
      const float sine = (p.radius_start - p.radius_end) / p.length;
      const float slope = sine / std::sqrt(1 - sine * sine);
      point.normal.z() -= std::clamp(local.z() - rho * slope, 0.0f, p.length);
      const float radius = 0.5f * (p.radius_start + p.radius_end);
      half = {kPi * radius, 0.5f * p.length};
      point.uv = {quick_atan2(local.x(), -local.y()) / kPi, 1 - 2 * local.z() / p.length};
      break;
    }
  }
  if (surface.repeats > 0) {
    point.uv = 0.5f * Vector2f::Ones() + surface.repeats * point.uv.cwiseProduct(half);
    point.texels_per_metre = surface.repeats * static_cast<float>(picture.width());
  } else {
    point.uv = 0.5f * (point.uv + Vector2f::Ones());
    point.texels_per_metre = std::max(static_cast<float>(picture.width()) / (2 * half.x()),
                                      static_cast<float>(picture.height()) / (2 * half.y()));
  }
  point.uv += surface.offset;
  return point;
}

}  // namespace stillpoint::generated
