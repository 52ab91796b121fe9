#include "core/sequence/generated/view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillpoint::generated {
namespace {

void add(const Vector3f& p, const Camera& camera, ImageBounds& bounds) {
  const float x = static_cast<float>(camera.fx) * p.x() / p.z() + static_cast<float>(camera.cx);
  const float y = static_cast<float>(camera.fy) * p.y() / p.z() + static_cast<float>(camera.cy);
  bounds.left = std::min(bounds.left, x), bounds.right = std::max(bounds.right, x);
  bounds.up = std::min(bounds.up, y), bounds.down = std::max(bounds.down, y);
  bounds.nearest = std::min(bounds.nearest, p.z());
}

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

/// Of a primitive's bounding box.
ImageBounds bounds_of(const Primitive& p, const View& view, const Camera& camera) {
  const auto corners = corners_in_camera(p, view);
  ImageBounds bounds;
  for (std::size_t k = 0; k < 8; ++k) {
    const Vector3f& a = corners[k];
    if (a.z() >= kNear)
      add(a, camera, bounds);
    else
      bounds.is_clipped = true;
    // Where an edge passes the near plane, the part before it counts.
    for (const std::size_t bit : {1u, 2u, 4u}) {
      const Vector3f& b = corners[k ^ bit];
      if (a.z() < kNear && b.z() >= kNear)
        add(a + (b - a) * ((kNear - a.z()) / (b.z() - a.z())), camera, bounds);
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

void SeenFaces::look(std::uint16_t id, int face, SeenFace& seen) const {
  const Primitive& p = view_->primitive(id);
  seen.surface = &scene_->surfaces[p.surface[static_cast<std::size_t>(face)]];
  seen.picture = &scene_->pictures[static_cast<std::size_t>(seen.surface->picture)];
  seen.fit = fit_picture(p, *seen.surface, *seen.picture, face);
  if (p.is_flat()) seen.normal = flat_normal(p, face);
}

TileLists::TileLists(const View& view, const Camera& camera)
    : width(camera.width), height(camera.height), columns((camera.width + kSide - 1) / kSide) {
  const int rows = (height + kSide - 1) / kSide;
  lists.resize(static_cast<std::size_t>(columns * rows));
  std::vector<Candidate> entries;
  for (std::size_t i = 0; i < view.seen.size(); ++i) {
    const auto id = static_cast<std::uint16_t>(i);
    ImageBounds b = bounds_of(view.primitive(id), view, camera);
    if (view.seen[i].shape == Shape::kRoom) b = {-1e6f, 1e6f, -1e6f, 1e6f, 1e8f};  // last, and everywhere
    if (b.right < -1 || b.left > static_cast<float>(width) || b.down < -1 ||
        b.up > static_cast<float>(height))
      continue;
    entries.push_back({b, id});
  }
  std::stable_sort(entries.begin(), entries.end(), [](const Candidate& a, const Candidate& b) {
    return a.bounds.nearest < b.bounds.nearest;
  });
  const auto tile = [](float pixel, int count) {
    return std::clamp(static_cast<int>(std::clamp(pixel, -1e6f, 1e6f)) / kSide, 0, count - 1);
  };
  for (const Candidate& e : entries)
    for (int y = tile(e.bounds.up - 2, rows); y <= tile(e.bounds.down + 2, rows); ++y)
      for (int x = tile(e.bounds.left - 2, columns); x <= tile(e.bounds.right + 2, columns); ++x)
        lists[static_cast<std::size_t>(y * columns + x)].push_back(e);
}

}  // namespace stillpoint::generated
