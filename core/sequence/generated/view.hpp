#pragma once

#include <span>
#include <vector>

#include "core/sequence/generated/scene.hpp"

namespace stillpoint::generated {

/// Everything as one camera sees it at one instant. Refers to the scene and the instant, which must outlive
/// it.
struct View {
  View(const Scene& scene, const Camera& camera, const Instant& instant);

  /// The direction of a pixel in camera coordinates; its z is 1, so lengths along it are depths.
  [[nodiscard]] Vector3f ray(float x, float y) const {
    return {(x - cx) * inverse_fx, (y - cy) * inverse_fy, 1.0f};
  }
  [[nodiscard]] const Primitive& primitive(std::uint16_t id) const {
    const std::size_t fixed_count = fixed->size();
    return id < fixed_count ? (*fixed)[id] : (*actors)[id - fixed_count];
  }

  const std::vector<Primitive>* fixed;
  const std::vector<Primitive>* actors;
  const std::vector<Blob>* blobs;
  std::vector<SeenPrimitive> seen;  ///< by id: the fixed ones, then the dynamic objects
  Matrix3f rotation;                ///< world from camera
  Vector3f position;                ///< of the camera, world, m
  float cx, cy, inverse_fx, inverse_fy, inverse_focal;
};

struct Candidate {
  float nearest;  ///< no point of it is nearer than this, m
  std::uint16_t id;
};

/// For each tile of the image, the primitives that may show in it, nearest first. The room is in every list.
struct TileLists {
  static constexpr int kSide = 16;  // px
  TileLists(const View& view, const Camera& camera);

  [[nodiscard]] std::span<const Candidate> at(int x, int y) const {
    return lists[static_cast<std::size_t>(y / kSide * columns + x / kSide)];
  }

  int width, height, columns;
  std::vector<std::vector<Candidate>> lists;
};

struct Found {
  std::uint16_t id = 0;
  Hit hit;
};

/// The first of the candidates that a ray meets.
[[nodiscard]] inline Found nearest(const View& view, std::span<const Candidate> candidates,
                                   const Vector3f& ray) {
  Found found;
  for (const Candidate& c : candidates) {
    if (c.nearest > found.hit.depth) break;
    if (intersect(view.seen[c.id], ray, found.hit)) found.id = c.id;
  }
  return found;
}

}  // namespace stillpoint::generated
