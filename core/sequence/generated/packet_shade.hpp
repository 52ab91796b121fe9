#pragma once

#include <cmath>

#include "core/sequence/generated/packet.hpp"
#include "core/sequence/generated/view.hpp"

namespace stillpoint::generated {

/// What a pixel's samples of one face share: computed for the first of them.
template <int N>
struct Shared {
  Ints<N> id = broadcast<N>(-1), face = broadcast<N>(-1);
  Floats<N> level{};                              ///< of the picture, before it is rounded
  Vectors<N> normal{{}, {}, broadcast<N>(1.0f)};  ///< world; of flat faces only
};

/// Points of one face: outward normals of round ones in local coordinates (not normalised), and picture
/// coordinates.
template <int N>
struct FacePoints {
  Vectors<N> normal;
  Floats<N> u, v;  ///< from -1 to 1 over the picture
};

/// atan2 to about 0.01 rad: picture coordinates need no better, and it runs for every sample on a limb.
template <int N>
STILLPOINT_PACKET Floats<N> quick_atan2(const Floats<N>& y, const Floats<N>& x) {
  constexpr float kPi = 3.14159265f;  // single precision, as all of a packet is
  const Floats<N> ax = absolute<N>(x), ay = absolute<N>(y);
  const Floats<N> q = lesser<N>(ax, ay) / (greater<N>(ax, ay) + 1e-20f);
  Floats<N> a = q * (kPi / 4 + 0.273f * (1 - q));
  a = ay > ax ? kPi / 2 - a : a;
  a = x < 0 ? kPi - a : a;
  return y < 0 ? -a : a;
}

/// log2 with the mantissa taken as straight: good to 0.09, plenty for choosing a level.
template <int N>
STILLPOINT_PACKET Floats<N> quick_log2(const Floats<N>& x) {
  return to_floats<N>(reinterpret_cast<Ints<N>>(x)) * (1.0f / 8388608.0f) - 126.94f;
}

/// Where points of a face (local coordinates) lie on its picture, from -1 to 1, and their normals.
template <int N>
STILLPOINT_PACKET FacePoints<N> describe(const Primitive& p, const Vectors<N>& local, int face) {
  constexpr float kPi = 3.14159265f;  // single precision, as all of a packet is
  const float sign = face % 2 == 1 ? 1.0f : -1.0f;
  FacePoints<N> points{local, -local.x, -local.z};
  switch (p.shape) {
    case Shape::kBox:
    case Shape::kRoom:  // their normals are the faces' own
      // As someone looking at the face sees it: u to the right, v downwards.
      points.u = face / 2 == 0 ? sign * local.y : face / 2 == 1 ? -sign * local.x : local.x;
      if (face / 2 == 2) points.v = -sign * local.y;
      if (p.shape == Shape::kRoom) points.u = -points.u;
      return points;
    case Shape::kCylinder:
      if (face == 1) {
        points.normal.x = points.normal.y = Floats<N>{};
        points.u = local.x, points.v = -local.y;
        return points;
      }
      points.normal.z = Floats<N>{};
      break;
    case Shape::kCone: {
      const float sine = (p.radius_start - p.radius_end) / p.length;
      const float slope = sine / std::sqrt(1 - sine * sine);
      const Floats<N> along = local.z - square_root<N>(local.x * local.x + local.y * local.y) * slope;
      points.normal.z -= along < 0.0f       ? broadcast<N>(0.0f)
                         : along > p.length ? broadcast<N>(p.length)
                                            : along;
      points.v = 1 - 2 * local.z / p.length;
      break;
    }
    case Shape::kEllipsoid:
      break;
  }
  points.u = quick_atan2<N>(local.x, -local.y) / kPi;
  return points;
}

template <int N>
STILLPOINT_PACKET Vectors<N> normalized(const Vectors<N>& v) {
  const Floats<N> square = dot<N>(v, v), length = square_root<N>(square);
  const Ints<N> known = square > 0;
  return {known ? v.x / length : v.x, known ? v.y / length : v.y, known ? v.z / length : v.z};
}

/// Texels at an index and beside it.
template <int N>
STILLPOINT_PACKET void look_up(const std::uint32_t* texels, const Ints<N>& index, Ints<N>& left,
                               Ints<N>& right) {
  const Bits<N> at = reinterpret_cast<Bits<N>>(index);  // widens for nothing
  Pairs<N> first, last;
  for (int i = 0; i < N / 2; ++i) {
    std::uint64_t pair = 0;
    std::memcpy(&pair, texels + at[i], sizeof pair);
    first[i] = pair;
    std::memcpy(&pair, texels + at[i + N / 2], sizeof pair);
    last[i] = pair;
  }
  part<N>(first, last, left, right);
}

/// Where a picture's reduced copies lie, for each ray its own.
template <int N>
struct LevelPlaces {
  Ints<N> width, height, offset;
};
template <int N>
STILLPOINT_PACKET LevelPlaces<N> places_of(const Texture& picture, const Ints<N>& level) {
  const Texture::Level& first = picture.level(level[0]);
  LevelPlaces<N> places{broadcast<N>(first.width), broadcast<N>(first.height), broadcast<N>(first.offset)};
  if (!any<N>(level != level[0])) return places;
  for (int i = 1; i < N; ++i) {
    const Texture::Level& l = picture.level(level[i]);
    places.width[i] = l.width, places.height[i] = l.height, places.offset[i] = l.offset;
  }
  return places;
}

template <int N>
STILLPOINT_PACKET Floats<N> channel(const Ints<N>& texels, int k) {
  return to_floats<N>(texels >> 8 * k & 255);
}

/// Bilinear colour (BGR, 0 to 255) at (u, v) in repeats of the texture, v downwards, on a level (0 = full
/// size).
template <int N>
STILLPOINT_PACKET Vectors<N> sample(const Texture& picture, const Floats<N>& u, const Floats<N>& v,
                                    const Ints<N>& level) {
  const LevelPlaces<N> at = places_of<N>(picture, level);
  const Floats<N> x = u * to_floats<N>(at.width) - 0.5f, y = v * to_floats<N>(at.height) - 0.5f;
  const Ints<N> x0 = floor_of<N>(x), y0 = floor_of<N>(y);
  const Floats<N> ax = x - to_floats<N>(x0), ay = y - to_floats<N>(y0);
  const Ints<N> column = at.offset + (x0 & (at.width - 1)), rows = at.height - 1, stride = at.width + 1;
  Ints<N> a, b, c, d;
  look_up<N>(picture.texels(), column + (y0 & rows) * stride, a, b);
  look_up<N>(picture.texels(), column + ((y0 + 1) & rows) * stride, c, d);
  Floats<N> bgr[3];
  for (int k = 0; k < 3; ++k) {
    const Floats<N> above = channel<N>(a, k) * (1 - ax) + channel<N>(b, k) * ax;
    const Floats<N> below = channel<N>(c, k) * (1 - ax) + channel<N>(d, k) * ax;
    bgr[k] = above * (1 - ay) + below * ay;
  }
  return {bgr[0], bgr[1], bgr[2]};
}

/// The share of the light that arrives at points of a surface, 0 to 1; 1 outside of it.
template <int N>
STILLPOINT_PACKET Floats<N> light_at(const ShadowPlane& plane, const Vectors<N>& world,
                                     const Ints<N>& there) {
  const Floats<N> x = (world.x - plane.corner.x()) * plane.texels_per_metre - 0.5f;
  const Floats<N> y = (world.y - plane.corner.y()) * plane.texels_per_metre - 0.5f;
  const Ints<N> x0 = truncated<N>(x), y0 = truncated<N>(y);
  const Ints<N> inside =
      there & (x >= 0) & (y >= 0) & (x0 < plane.light.cols - 1) & (y0 < plane.light.rows - 1);
  const Floats<N> ax = x - to_floats<N>(x0), ay = y - to_floats<N>(y0);
  Ints<N> corners[4] = {};
  for (int i = 0; i < N; ++i) {
    if (inside[i] == 0) continue;
    const std::uint8_t* top = plane.light.ptr(y0[i]) + x0[i];
    const std::uint8_t* bottom = top + plane.light.step[0];
    corners[0][i] = top[0], corners[1][i] = top[1], corners[2][i] = bottom[0], corners[3][i] = bottom[1];
  }
  const Floats<N> above = to_floats<N>(corners[0]) * (1 - ax) + to_floats<N>(corners[1]) * ax;
  const Floats<N> below = to_floats<N>(corners[2]) * (1 - ax) + to_floats<N>(corners[3]) * ax;
  return inside ? (above * (1 - ay) + below * ay) / 255.0f : broadcast<N>(1.0f);
}

/// The share of light that furniture and people let through to level surfaces: `sun` and `sky` are dimmed.
template <int N>
STILLPOINT_PACKET void cast_shadow(const Scene& scene, const View& view, const Vectors<N>& world,
                                   const Ints<N>& level, Floats<N>& sun, Floats<N>& sky) {
  for (const ShadowPlane& plane : scene.planes) {
    const Ints<N> there = level & ~(absolute<N>(world.z - plane.height) > 0.004f);
    if (!any<N>(there)) continue;
    const Floats<N> lit = light_at<N>(plane, world, there);
    sun *= lit;
    sky *= 0.55f + 0.45f * lit;
  }
  const Ints<N> on_floor = level & (world.z < 0.02f);
  if (!any<N>(on_floor)) return;
  for (const Blob& blob : *view.blobs) {
    const Floats<N> dx = world.x - blob.centre.x(), dy = world.y - blob.centre.y();
    const Floats<N> q = (dx * dx + dy * dy) / (blob.radius * blob.radius);
    const Ints<N> under = on_floor & (q < 1);
    sun = under ? sun * (1 - blob.strength * (1 - q)) : sun;
    sky = under ? sky * (1 - 0.5f * blob.strength * (1 - q)) : sky;
  }
}

/// One face of one primitive, and the rays of a packet that met it.
template <int N>
struct MetFace {
  std::int32_t id;
  int face;
  Ints<N> who;
  Vectors<N> local;  ///< the points met
  Vectors<N> ray;    ///< in camera coordinates

  /// Of the rays, world.
  STILLPOINT_PACKET Vectors<N> direction(const View& view) const {
    return transformed<N>(view.rotation, ray);
  }
};

template <int N>
STILLPOINT_PACKET Floats<N> light(const Scene& scene, const View& view, const Primitive& p,
                                  const MetFace<N>& met, const Floats<N>& depth, const Vectors<N>& normal) {
  Floats<N> sky = 0.71f + 0.10f * normal.z - 0.05f * normal.x;
  Floats<N> sun = 0.42f * greater<N>(Floats<N>{}, dot<N>(normal, light_direction()));
  const Ints<N> level = met.who & (normal.z > 0.9f);
  if (any<N>(level))
    cast_shadow<N>(scene, view, along<N>(view.position, depth, met.direction(view)), level, sun, sky);
  if (p.shape == Shape::kRoom) {
    const Floats<N> local[3] = {met.local.x, met.local.y, met.local.z};
    for (int axis = 0; axis < 3; ++axis) {  // corners of a room are darker
      if (axis == met.face / 2) continue;
      const Floats<N> gap = (1 - absolute<N>(local[axis])) * p.half[axis];
      if (!any<N>(gap < 0.8f)) continue;
      sky = gap < 0.8f ? sky * (1 - 0.3f * (1 - gap / 0.8f) * (1 - gap / 0.8f)) : sky;
    }
  }
  return sky + sun;
}

/// Computes what a pixel's samples of a face share, for those rays that are the first of their pixels to meet
/// it; the normals of round faces anew for all.
template <int N>
STILLPOINT_PACKET void share(const View& view, const Primitive& p, const SeenFace& seen,
                             const MetFace<N>& met, const Floats<N>& depth, const Vectors<N>& local_normal,
                             Shared<N>& shared) {
  const Ints<N> newly = met.who & ~((shared.id == met.id) & (shared.face == met.face));
  const bool any_newly = any<N>(newly);
  if (!p.is_flat())
    assign<N>(met.who, normalized<N>(transformed<N>(p.local_from_world.transpose(), local_normal)),
              shared.normal);
  else if (any_newly)
    assign<N>(newly, broadcast<N>(seen.normal), shared.normal);
  if (!any_newly) return;
  const Floats<N> cosine =
      absolute<N>(dot<N>(shared.normal, met.direction(view))) / square_root<N>(dot<N>(met.ray, met.ray));
  const Floats<N> slant = greater<N>(broadcast<N>(0.08f), cosine);
  // Four samples share a pixel, so each covers about half its width; the root splits the slant between axes.
  const Floats<N> texels =
      depth * view.inverse_focal * seen.fit.texels_per_metre * 0.6f / square_root<N>(slant);
  shared.id = newly ? broadcast<N>(met.id) : shared.id;
  shared.face = newly ? broadcast<N>(met.face) : shared.face;
  shared.level = newly ? quick_log2<N>(texels) + 0.5f : shared.level;
}

/// What the rays `who` see of the one face that they met.
template <int N>
STILLPOINT_PACKET Vectors<N> face_colour(const Scene& scene, const View& view, SeenFaces& faces,
                                         const Vectors<N>& ray, const Floats<N>& depth, std::int32_t id,
                                         int face, const Ints<N>& who, float level_shift, Shared<N>& shared) {
  const auto number = static_cast<std::uint16_t>(id);
  const Primitive& p = view.primitive(number);
  const SeenPrimitive& seen = view.seen[number];
  const SeenFace& look = faces.at(number, face);
  const Surface& surface = *look.surface;
  const MetFace<N> met{id, face, who, along<N>(seen.origin, depth, seen.rotation, ray), ray};
  const FacePoints<N> points = describe<N>(p, met.local, face);
  share<N>(view, p, look, met, depth, points.normal, shared);
  const Floats<N> u = 0.5f + look.fit.repeats * (points.u * look.fit.half.x()) + surface.offset.x();
  const Floats<N> v = 0.5f + look.fit.repeats * (points.v * look.fit.half.y()) + surface.offset.y();
  const Ints<N> level = truncated<N>(greater<N>(Floats<N>{}, shared.level + level_shift));
  Vectors<N> colour = sample<N>(*look.picture, u, v, level);
  colour.x *= surface.tint.x(), colour.y *= surface.tint.y(), colour.z *= surface.tint.z();
  if (surface.glows) return colour;
  const Floats<N> lit = light<N>(scene, view, p, met, depth, shared.normal);
  return {colour.x * lit, colour.y * lit, colour.z * lit};
}

/// The colours (BGR, 0 to 255 and beyond where it glares) of what a packet's rays met.
/// @param level_shift spreads a pixel's samples over neighbouring mip levels
template <int N>
STILLPOINT_PACKET Vectors<N> shade(const Scene& scene, const View& view, SeenFaces& faces,
                                   const Vectors<N>& ray, const Hits<N>& hits, float level_shift,
                                   Shared<N>& shared) {
  Vectors<N> colours{};
  Ints<N> left = broadcast<N>(-1);
  for (int i = 0; i < N; ++i) {
    if (left[i] == 0) continue;
    const Ints<N> who = left & (hits.id == hits.id[i]) & (hits.face == hits.face[i]);
    assign<N>(who,
              face_colour<N>(scene, view, faces, ray, hits.depth, hits.id[i], hits.face[i], who, level_shift,
                             shared),
              colours);
    left &= ~who;
    if (!any<N>(left)) break;
  }
  return colours;
}

}  // namespace stillpoint::generated
