#pragma once

#include "core/sequence/generated/packet.hpp"

namespace stillpoint::generated {

template <int N>
STILLPOINT_PACKET void keep(const Candidacy<N>& who, const Ints<N>& met, const Floats<N>& t,
                            const Ints<N>& face, Hits<N>& hits) {
  const Ints<N> first = (t < hits.depth) | ((t == hits.depth) & (who.rank < hits.rank));
  const Ints<N> kept = who.allowed & met & (t > kNear) & first;
  hits.depth = kept ? t : hits.depth;
  hits.face = kept ? face : hits.face;
  hits.rank = kept ? who.rank : hits.rank;
  hits.id = kept ? broadcast<N>(who.id) : hits.id;
}

template <int N>
STILLPOINT_PACKET void meet_slab(float o, const Floats<N>& d, int axis, Floats<N>& enter, Ints<N>& enter_face,
                                 Floats<N>& leave, Ints<N>& leave_face) {
  const Floats<N> inverse = 1.0f / d;
  const Floats<N> down = (-1.0f - o) * inverse, up = (1.0f - o) * inverse;
  const Ints<N> rising = inverse > 0;  // also right when d is a zero of either sign
  const Floats<N> first = rising ? down : up, second = rising ? up : down;
  const Ints<N> later = first > enter, earlier = second < leave;
  const std::int32_t low = 2 * axis, high = 2 * axis + 1;
  enter = later ? first : enter;
  enter_face = later ? high + rising : enter_face;  // a true comparison is -1
  leave = earlier ? second : leave;
  leave_face = earlier ? low - rising : leave_face;
}

template <int N>
STILLPOINT_PACKET void meet_box(const Candidacy<N>& who, const Vector3f& o, const Vectors<N>& d,
                                bool from_inside, Hits<N>& hits) {
  Floats<N> enter = broadcast<N>(-1e9f), leave = broadcast<N>(1e9f);
  Ints<N> enter_face{}, leave_face{};
  meet_slab<N>(o.x(), d.x, 0, enter, enter_face, leave, leave_face);
  meet_slab<N>(o.y(), d.y, 1, enter, enter_face, leave, leave_face);
  meet_slab<N>(o.z(), d.z, 2, enter, enter_face, leave, leave_face);
  if (from_inside)
    keep<N>(who, broadcast<N>(-1), leave, leave_face, hits);
  else
    keep<N>(who, enter < leave, enter, enter_face, hits);
}

/// Entry into the sphere of radius r at height z.
template <int N>
STILLPOINT_PACKET void meet_sphere(const Candidacy<N>& who, const Vector3f& o, const Vectors<N>& d, float z,
                                   float r, Hits<N>& hits) {
  const float oz = o.z() - z;
  const Floats<N> a = dot<N>(d, d), b = o.x() * d.x + o.y() * d.y + oz * d.z;
  const float c = o.x() * o.x() + o.y() * o.y() + oz * oz - r * r;
  const Floats<N> root = b * b - a * c;
  const Ints<N> met = root > 0;
  if (any<N>(met)) keep<N>(who, met, (-b - square_root<N>(root)) / a, Ints<N>{}, hits);
}

template <int N>
STILLPOINT_PACKET void meet_cylinder(const Candidacy<N>& who, const Vector3f& o, const Vectors<N>& d,
                                     Hits<N>& hits) {
  const Floats<N> a = d.x * d.x + d.y * d.y, b = o.x() * d.x + o.y() * d.y;
  const float c = o.x() * o.x() + o.y() * o.y() - 1.0f;
  const Floats<N> root = b * b - a * c;
  const Floats<N> side = (-b - square_root<N>(root)) / a;
  const Ints<N> on_side = (root > 0) & (a > 0) & (absolute<N>(o.z() + side * d.z) <= 1.0f);
  keep<N>(who, on_side, side, Ints<N>{}, hits);
  const Floats<N> cap = ((d.z < 0 ? broadcast<N>(1.0f) : broadcast<N>(-1.0f)) - o.z()) / d.z;
  const Floats<N> x = o.x() + cap * d.x, y = o.y() + cap * d.y;
  keep<N>(who, ~on_side & (d.z != 0) & (x * x + y * y <= 1.0f), cap, broadcast<N>(1), hits);
}

/// One root of a cone's side. @returns where it lies on the side that there is
template <int N>
STILLPOINT_PACKET Ints<N> meet_cone_side(const Candidacy<N>& who, const SeenPrimitive& p, const Vectors<N>& d,
                                         const Ints<N>& meets, const Floats<N>& t, float k,
                                         const Floats<N>& dk, Hits<N>& hits) {
  const Floats<N> rho = k - t * dk, centre = p.origin.z() + t * d.z - rho * p.cone_slope;
  const Ints<N> met = meets & (rho >= 0) & (centre >= 0) & (centre <= p.length);
  keep<N>(who, met, t, Ints<N>{}, hits);
  return met;
}

template <int N>
STILLPOINT_PACKET void meet_cone(const Candidacy<N>& who, const SeenPrimitive& p, const Vectors<N>& d,
                                 Hits<N>& hits) {
  const Vector3f& o = p.origin;
  // The side: rho² = (offset - slope z)², valid where the touching sphere's centre lies on the axis segment.
  const float k = p.cone_offset - p.cone_slope * o.z();
  const Floats<N> dk = p.cone_slope * d.z;
  const Floats<N> a = d.x * d.x + d.y * d.y - dk * dk;
  const Floats<N> b = o.x() * d.x + o.y() * d.y + dk * k;
  const float c = o.x() * o.x() + o.y() * o.y() - k * k;
  const Floats<N> root = b * b - a * c;
  const Ints<N> meets = (root > 0) & (a != 0), both = meets & ~(a > 0);
  Candidacy<N> ends = who;
  if (any<N>(meets)) {
    const Floats<N> s = square_root<N>(root);
    const Ints<N> met = meet_cone_side<N>(who, p, d, meets, (-b - s) / a, k, dk, hits);
    ends.allowed &= ~(met & (a > 0));
    // Where a > 0 the second root is where the ray leaves.
    if (any<N>(both)) (void)meet_cone_side<N>(who, p, d, both, (-b + s) / a, k, dk, hits);
  }
  if (!any<N>(ends.allowed)) return;
  meet_sphere<N>(ends, o, d, 0, p.radius_start, hits);
  meet_sphere<N>(ends, o, d, p.length, p.radius_end, hits);
}

/// Where rays through (x, y, 1) enter a primitive (leave it, for rooms), nearer than what they met before.
template <int N>
STILLPOINT_PACKET void meet(const Candidacy<N>& who, const SeenPrimitive& p, const Vectors<N>& ray,
                            Hits<N>& hits) {
  const Vectors<N> d = transformed<N>(p.rotation, ray);
  switch (p.shape) {
    case Shape::kBox:
    case Shape::kRoom:
      return meet_box<N>(who, p.origin, d, p.shape == Shape::kRoom, hits);
    case Shape::kEllipsoid:
      return meet_sphere<N>(who, p.origin, d, 0, 1, hits);
    case Shape::kCylinder:
      return meet_cylinder<N>(who, p.origin, d, hits);
    case Shape::kCone:
      return meet_cone<N>(who, p, d, hits);
  }
}

}  // namespace stillpoint::generated
