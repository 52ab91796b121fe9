#pragma once

#include "core/sequence/generated/lanes.hpp"
#include "core/sequence/generated/primitives.hpp"

// Rays beside each other, cast together: a lane a ray.

namespace stillpoint::generated {

/// Points or directions.
template <int N>
struct Vectors {
  Floats<N> x, y, z;
};

// Sums in the order of Eigen's products of three: a + (b + c).
template <int N>
STILLPOINT_PACKET Floats<N> dot(const Vectors<N>& a, const Vectors<N>& b) {
  return a.x * b.x + (a.y * b.y + a.z * b.z);
}
template <int N>
STILLPOINT_PACKET Floats<N> dot(const Vectors<N>& a, const Vector3f& b) {
  return a.x * b.x() + (a.y * b.y() + a.z * b.z());
}
template <int N>
STILLPOINT_PACKET Vectors<N> transformed(const Matrix3f& m, const Vectors<N>& v) {
  return {m(0, 0) * v.x + (m(0, 1) * v.y + m(0, 2) * v.z), m(1, 0) * v.x + (m(1, 1) * v.y + m(1, 2) * v.z),
          m(2, 0) * v.x + (m(2, 1) * v.y + m(2, 2) * v.z)};
}

template <int N>
STILLPOINT_PACKET Vectors<N> along(const Vector3f& origin, const Floats<N>& t, const Vectors<N>& direction) {
  return {origin.x() + t * direction.x, origin.y() + t * direction.y, origin.z() + t * direction.z};
}
/// origin + t * (m * v), as Eigen multiplies it out: t goes into m first.
template <int N>
STILLPOINT_PACKET Vectors<N> along(const Vector3f& origin, const Floats<N>& t, const Matrix3f& m,
                                   const Vectors<N>& v) {
  return {origin.x() + (t * m(0, 0) * v.x + (t * m(0, 1) * v.y + t * m(0, 2) * v.z)),
          origin.y() + (t * m(1, 0) * v.x + (t * m(1, 1) * v.y + t * m(1, 2) * v.z)),
          origin.z() + (t * m(2, 0) * v.x + (t * m(2, 1) * v.y + t * m(2, 2) * v.z))};
}
template <int N>
STILLPOINT_PACKET Vectors<N> broadcast(const Vector3f& v) {
  return {broadcast<N>(v.x()), broadcast<N>(v.y()), broadcast<N>(v.z())};
}
template <int N>
STILLPOINT_PACKET void assign(const Ints<N>& mask, const Vectors<N>& from, Vectors<N>& to) {
  to.x = mask ? from.x : to.x;
  to.y = mask ? from.y : to.y;
  to.z = mask ? from.z : to.z;
}

/// What the rays of a packet met first.
template <int N>
struct Hits {
  Floats<N> depth = broadcast<N>(1e9f);  ///< m
  Ints<N> face{}, id{}, rank = broadcast<N>(std::int32_t{1} << 30);
};

template <int N>
STILLPOINT_PACKET void assign(const Ints<N>& mask, const Hits<N>& from, Hits<N>& to) {
  to.depth = mask ? from.depth : to.depth;
  to.face = mask ? from.face : to.face;
  to.id = mask ? from.id : to.id;
}

/// The rays that may meet a primitive, and its place in the order in which each looks at its candidates: of
/// those at one depth the first is met.
template <int N>
struct Candidacy {
  std::int32_t id;
  Ints<N> allowed, rank;
};

}  // namespace stillpoint::generated
