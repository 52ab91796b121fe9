#include "core/sequence/generated/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/sequence/generated/view.hpp"

namespace stillpoint::generated {
namespace {

/// Casts every pixel at one instant against its tile's candidates, which come nearest first.
Rendering cast_pixels(const View& view, const TileLists& tiles) {
  Rendering result;
  result.depth.create(tiles.height, tiles.width, CV_32FC1);
  result.id.create(tiles.height, tiles.width, CV_16UC1);
  for (int y = 0; y < tiles.height; ++y) {
    float* depth = result.depth.ptr<float>(y);
    std::uint16_t* id = result.id.ptr<std::uint16_t>(y);
    for (int x = 0; x < tiles.width; ++x) {
      const Found found =
          nearest(view, tiles.at(x, y), view.ray(static_cast<float>(x), static_cast<float>(y)));
      depth[x] = found.hit.depth;
      id[x] = found.id;
    }
  }
  return result;
}

/// The few primitives that a pixel's samples can meet: those seen about it at mid exposure.
struct Nearby {
  std::array<std::uint16_t, 12> ids;
  int count = 0;
  void add(std::uint16_t id) {
    for (int i = 0; i < count; ++i)
      if (ids[static_cast<std::size_t>(i)] == id) return;
    if (count < static_cast<int>(ids.size())) ids[static_cast<std::size_t>(count++)] = id;
  }
};

Nearby gather(const cv::Mat& id, int x, int y, int reach) {
  Nearby nearby;
  nearby.add(id.at<std::uint16_t>(y, x));
  for (const int r : {1, (reach + 1) / 2, reach}) {
    const int left = std::max(0, x - r), right = std::min(id.cols - 1, x + r);
    const int up = std::max(0, y - r), down = std::min(id.rows - 1, y + r);
    for (const int v : {up, y, down})
      for (const int u : {left, x, right}) nearby.add(id.at<std::uint16_t>(v, u));
    if (r == reach) break;
  }
  return nearby;
}

/// 255 where a pixel has nothing but one primitive about it: most of an image, and quick to sample.
cv::Mat where_alone(const cv::Mat& id, int reach) {
  cv::Mat least, most;
  const cv::Mat square(2 * reach + 1, 2 * reach + 1, CV_8UC1, cv::Scalar(1));
  cv::erode(id, least, square);
  cv::dilate(id, most, square);
  return least == most;
}

/// Where in the pixel each sample lies: a rotated grid.
constexpr std::array<std::array<float, 2>, 4> kOffsets = {
    {{-0.125f, -0.375f}, {0.375f, -0.125f}, {-0.375f, 0.125f}, {0.125f, 0.375f}}};

/// What a pixel's samples of one face share: computed for the first of them.
struct Shared {
  int id = -1, face = -1;
  float level = 0;           ///< of the picture, before it is rounded
  Vector3f normal{0, 0, 1};  ///< world; of flat faces only
};

class Shader {
 public:
  explicit Shader(const Scene& scene) : scene_(scene) {}

  /// The colour of a hit. `level_shift` spreads a pixel's samples over neighbouring mip levels.
  [[nodiscard]] Vector3f colour(const View& view, const Found& found, const Vector3f& ray, float level_shift,
                                Shared& shared) const {
    const Primitive& p = view.primitive(found.id);
    const SeenPrimitive& seen = view.seen[found.id];
    const Vector3f local = seen.origin + found.hit.depth * (seen.rotation * ray);
    const Surface& surface = scene_.surfaces[p.surface[static_cast<std::size_t>(found.hit.face)]];
    const Texture& picture = scene_.pictures[static_cast<std::size_t>(surface.picture)];
    const SurfacePoint point = describe(p, surface, picture, local, found.hit.face);
    const Vector3f direction = view.rotation * ray;
    const bool known = shared.id == found.id && shared.face == found.hit.face;
    const bool flat = p.shape == Shape::kBox || p.shape == Shape::kRoom;
    if (!known || !flat) shared.normal = (p.local_from_world.transpose() * point.normal).normalized();
    if (!known) {
      const float slant = std::max(0.08f, std::abs(shared.normal.dot(direction)) / ray.norm());
      // Four samples share a pixel, so each covers about half its width; the root splits the slant between
      // axes.
      const float texels =
          found.hit.depth * view.inverse_focal * point.texels_per_metre * 0.6f / std::sqrt(slant);
      shared.id = found.id, shared.face = found.hit.face;
      shared.level = quick_log2(texels) + 0.5f;
    }
    const int level = static_cast<int>(std::max(0.0f, shared.level + level_shift));
    const Vector3f base = picture.sample(point.uv.x(), point.uv.y(), level).cwiseProduct(surface.tint);
    if (surface.glows) return base;
    return base *
           light(view, p, local, found.hit.face, shared.normal, view.position + found.hit.depth * direction);
  }

 private:
  /// log2 with the mantissa taken as straight: good to 0.09, plenty for choosing a level.
  static float quick_log2(float x) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    return static_cast<float>(bits) * (1.0f / 8388608.0f) - 126.94f;
  }

  [[nodiscard]] float light(const View& view, const Primitive& p, const Vector3f& local, int face,
                            const Vector3f& normal, const Vector3f& world) const {
    float sky = 0.71f + 0.10f * normal.z() - 0.05f * normal.x();
    float sun = 0.42f * std::max(0.0f, normal.dot(light_direction()));
    if (normal.z() > 0.9f) {
      for (const ShadowPlane& plane : scene_.planes) {
        const float lit = plane.at(world);
        sun *= lit;
        sky *= 0.55f + 0.45f * lit;
      }
      if (world.z() < 0.02f)
        for (const Blob& blob : *view.blobs) {
          const float q = (world.head<2>() - blob.centre).squaredNorm() / (blob.radius * blob.radius);
          if (q < 1) sun *= 1 - blob.strength * (1 - q), sky *= 1 - 0.5f * blob.strength * (1 - q);
        }
    }
    if (p.shape == Shape::kRoom)
      for (int axis = 0; axis < 3; ++axis)  // corners of a room are darker
        if (axis != face / 2) {
          const float gap = (1 - std::abs(local[axis])) * p.half[axis];
          if (gap < 0.8f) sky *= 1 - 0.3f * (1 - gap / 0.8f) * (1 - gap / 0.8f);
        }
    return sky + sun;
  }

  const Scene& scene_;
};

}  // namespace

Rendering cast_depth(const Scene& scene, const Camera& camera, const Instant& middle) {
  const View view(scene, camera, middle);
  return cast_pixels(view, TileLists(view, camera));
}

Rendering cast_frame(const Scene& scene, const Camera& camera, const Instant& middle,
                     std::span<const Instant> exposure, double blur_px) {
  const View mid(scene, camera, middle);
  const TileLists tiles(mid, camera);
  Rendering result = cast_pixels(mid, tiles);
  result.colour.create(tiles.height, tiles.width, CV_32FC3);
  std::vector<View> views;
  for (const Instant& instant : exposure) views.emplace_back(scene, camera, instant);
  const Shader shader(scene);
  const int reach = std::max(1, static_cast<int>(std::ceil(blur_px / 2)) + 1);
  const cv::Mat alone = where_alone(result.id, reach);
  const float share = 1.0f / static_cast<float>(views.size());

  for (int y = 0; y < tiles.height; ++y)
    for (int x = 0; x < tiles.width; ++x) {
      Nearby nearby;
      if (alone.at<std::uint8_t>(y, x) != 0)
        nearby.add(result.id.at<std::uint16_t>(y, x));
      else
        nearby = gather(result.id, x, y, reach);
      const std::span<const std::uint16_t> candidates(nearby.ids.data(),
                                                      static_cast<std::size_t>(nearby.count));
      Vector3f sum = Vector3f::Zero();
      Shared shared;
      for (std::size_t k = 0; k < views.size(); ++k) {
        const auto& offset = kOffsets[k % kOffsets.size()];
        const Vector3f ray =
            views[k].ray(static_cast<float>(x) + offset[0], static_cast<float>(y) + offset[1]);
        Found found{candidates.front(), {}};
        for (const std::uint16_t id : candidates)
          if (intersect(views[k].seen[id], ray, found.hit)) found.id = id;
        // A gap wider than what was looked at: the room is behind everything.
        if (found.hit.depth > 1e8f) found = nearest(views[k], tiles.at(x, y), ray);
        sum += shader.colour(views[k], found, ray, static_cast<float>(k) * share - 0.375f, shared);
      }
      result.colour.at<cv::Vec3f>(y, x) = {sum.x() * share, sum.y() * share, sum.z() * share};
    }
  return result;
}

}  // namespace stillpoint::generated
