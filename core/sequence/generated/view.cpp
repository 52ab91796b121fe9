#include "core/sequence/generated/view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillpoint::generated {
namespace {

/// The image rectangle and least depth of a primitive's bounding box.
struct Bounds {
  float left = 1e9f, right = -1e9f, up = 1e9f, down = -1e9f, nearest = 1e9f;
  void add(const Vector3f& p, const Camera& camera) {
    const float x = static_cast<float>(camera.fx) * p.x() / p.z() + static_cast<float>(camera.cx);
    const float y = static_cast<float>(camera.fy) * p.y() / p.z() + static_cast<float>(camera.cy);
    left = std::min(left, x), right = std::max(right, x);
    up = std::min(up, y), down = std::max(down, y);
    nearest = std::min(nearest, p.z());
  }
};

std::array<Vector3f, 8> corners_in_camera(const Primitive& p, const View& view) {
  const Matrix3f camera_from_local = view.rotation.transpose() * p.local_from_world.inverse();
  const Vector3f centre = view.rotation.transpose() * (p.centre - view.position);
  std::array<Vector3f, 8> corners;
  for (std::size_t k = 0; k < 8; ++k) {
    Vector3f local(k & 1 ? 1.0f : -1.0f, k & 2 ? 1.0f : -1.0f, k & 4 ? 1.0f : -1.0f);
    if (p.shape == Shape::kCone) {
      const float r = std::max(p.radius_start, p.radius_end);
      local = {local.x() * r, local.y() * r, local.z() > 0 ? p.length + p.radius_end : -p.radius_start};
    }
    corners[k] = centre + camera_from_local * local;
  }
  return corners;
}

Bounds bounds_of(const Primitive& p, const View& view, const Camera& camera) {
  const auto corners = corners_in_camera(p, view);
  Bounds bounds;
  for (std::size_t k = 0; k < 8; ++k) {
    const Vector3f& a = corners[k];
    if (a.z() >= kNear) bounds.add(a, camera);
    // Where an edge passes the near plane, the part before it counts.
    for (const std::size_t bit : {1u, 2u, 4u}) {
      const Vector3f& b = corners[k ^ bit];
      if (a.z() < kNear && b.z() >= kNear)
        bounds.add(a + (b - a) * ((kNear - a.z()) / (b.z() - a.z())), camera);
    }
  }
  return bounds;
}

}  // namespace

View::View(const Scene& scene, const Camera& camera, const Instant& instant)
    : fixed(&scene.fixed),
      actors(&instant.actors),
      blobs(&instant.blobs),
      rotation(instant.world_from_camera.linear().cast<float>()),
      position(instant.world_from_camera.translation().cast<float>()),
      cx(static_cast<float>(camera.cx)),
      cy(static_cast<float>(camera.cy)),
      inverse_fx(static_cast<float>(1.0 / camera.fx)),
      inverse_fy(static_cast<float>(1.0 / camera.fy)),
      inverse_focal(static_cast<float>(2.0 / (camera.fx + camera.fy))) {
  seen.reserve(fixed->size() + actors->size());
  for (const Primitive& p : *fixed) seen.push_back(see(p, rotation, position));
  for (const Primitive& p : *actors) seen.push_back(see(p, rotation, position));
}

TileLists::TileLists(const View& view, const Camera& camera)
    : width(camera.width), height(camera.height), columns((camera.width + kSide - 1) / kSide) {
  const int rows = (height + kSide - 1) / kSide;
  lists.resize(static_cast<std::size_t>(columns * rows));
  struct Entry {
    Bounds bounds;
    std::uint16_t id;
  };
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < view.seen.size(); ++i) {
    const auto id = static_cast<std::uint16_t>(i);
    Bounds b = bounds_of(view.primitive(id), view, camera);
    if (view.seen[i].shape == Shape::kRoom) b = {-1e6f, 1e6f, -1e6f, 1e6f, 1e8f};  // last, and everywhere
    if (b.right < -1 || b.left > static_cast<float>(width) || b.down < -1 ||
        b.up > static_cast<float>(height))
      continue;
    entries.push_back({b, id});
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.bounds.nearest < b.bounds.nearest; });
  const auto tile = [](float pixel, int count) {
    return std::clamp(static_cast<int>(std::clamp(pixel, -1e6f, 1e6f)) / kSide, 0, count - 1);
  };
  for (const Entry& e : entries)
    for (int y = tile(e.bounds.up - 2, rows); y <= tile(e.bounds.down + 2, rows); ++y)
      for (int x = tile(e.bounds.left - 2, columns); x <= tile(e.bounds.right + 2, columns); ++x)
        lists[static_cast<std::size_t>(y * columns + x)].push_back({e.bounds.nearest, e.id});
}

}  // namespace stillpoint::generated
