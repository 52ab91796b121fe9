#include "core/sequence/generated/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/sequence/generated/packet_find.hpp"
#include "core/sequence/generated/packet_shade.hpp"
#include "core/sequence/generated/view.hpp"

namespace stillpoint::generated {
namespace {

/// Where in the pixel each sample lies: a rotated grid.
constexpr std::array<std::array<float, 2>, 4> kOffsets = {
    {{-0.125f, -0.375f}, {0.375f, -0.125f}, {-0.375f, 0.125f}, {0.125f, 0.375f}}};

/// All that the pixels of a frame's colour are made of.
struct Exposure {
  const Scene& scene;
  const TileLists& tiles;
  std::vector<View> views;       // at its instants
  std::vector<SeenFaces> faces;  // of each
  int reach;                     // px, how far about a pixel what its samples meet may lie at mid exposure
  cv::Mat alone;                 // 255 where there is but one primitive so far about
};

/// 255 where a pixel has nothing but one primitive about it: most of an image, and quick to sample.
cv::Mat where_alone(const cv::Mat& id, int reach) {
  cv::Mat least, most;
  const cv::Mat square(2 * reach + 1, 2 * reach + 1, CV_8UC1, cv::Scalar(1));
  cv::erode(id, least, square);
  cv::dilate(id, most, square);
  return least == most;
}

/// Casts every pixel at one instant against its tile's candidates.
template <int N>
STILLPOINT_PACKET void cast_pixels(const View& view, const TileLists& tiles, Rendering& result) {
  for (int y = 0; y < tiles.height; ++y)
    for (int x = 0; x < tiles.width; x += N) {
      const Vectors<N> ray = rays<N>(view, {x, y}, 0, 0);
      const Hits<N> hits = nearest<N>(view, tiles.at(x, y), {x, y}, ray, broadcast<N>(-1), true);
      for (int i = 0; i < std::min(N, tiles.width - x); ++i) {
        result.depth.ptr<float>(y)[x + i] = hits.depth[i];
        result.id.ptr<std::uint16_t>(y)[x + i] = static_cast<std::uint16_t>(hits.id[i]);
      }
    }
}

template <int N>
STILLPOINT_PACKET bool is_alone(const cv::Mat& alone, const PacketPlace& place) {
  const std::uint8_t* row = alone.ptr(place.y) + place.x;
  return std::all_of(row, row + std::min(N, alone.cols - place.x), [](std::uint8_t is) { return is != 0; });
}

/// A packet's colour: the mean of its samples at all instants.
template <int N>
STILLPOINT_PACKET Vectors<N> cast_colour(Exposure& exposure, const cv::Mat& id, const PacketPlace& place) {
  Nearby<N> nearby;
  if (is_alone<N>(exposure.alone, place)) {
    nearby.count = 1;
    nearby.ids[0] = id.at<std::uint16_t>(place.y, place.x);
    nearby.ranks[0] = Ints<N>{};
  } else {
    look_about<N>(id, place, exposure.reach, nearby);
  }
  const std::vector<View>& views = exposure.views;
  const float share = 1.0f / static_cast<float>(views.size());
  Vectors<N> sum{};
  Shared<N> shared;
  for (std::size_t k = 0; k < views.size(); ++k) {
    const auto& offset = kOffsets[k % kOffsets.size()];
    const Vectors<N> ray = rays<N>(views[k], place, offset[0], offset[1]);
    Hits<N> hits = nearest<N>(views[k], nearby, ray);
    // A gap wider than what was looked at: the room is behind everything.
    if (const Ints<N> lost = hits.depth > 1e8f; any<N>(lost))
      assign<N>(lost, nearest<N>(views[k], exposure.tiles.at(place.x, place.y), place, ray, lost, false),
                hits);
    const Vectors<N> colour = shade<N>(exposure.scene, views[k], exposure.faces[k], ray, hits,
                                       static_cast<float>(k) * share - 0.375f, shared);
    sum.x += colour.x, sum.y += colour.y, sum.z += colour.z;
  }
  return {sum.x * share, sum.y * share, sum.z * share};
}

template <int N>
STILLPOINT_PACKET void cast_colours(Exposure& exposure, Rendering& result) {
  for (int y = 0; y < result.id.rows; ++y)
    for (int x = 0; x < result.id.cols; x += N) {
      const Vectors<N> colour = cast_colour<N>(exposure, result.id, {x, y});
      auto* pixel = result.colour.ptr<cv::Vec3f>(y) + x;
      for (int i = 0; i < std::min(N, result.id.cols - x); ++i)
        pixel[i] = {colour.x[i], colour.y[i], colour.z[i]};
    }
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void cast_pixels_by_eight(const View& view, const TileLists& tiles,
                                                  Rendering& result) {
  cast_pixels<8>(view, tiles, result);
}
[[gnu::target("avx2")]] void cast_colours_by_eight(Exposure& exposure, Rendering& result) {
  cast_colours<8>(exposure, result);
}
#else
void cast_pixels_by_eight(const View& view, const TileLists& tiles, Rendering& result) {
  cast_pixels<8>(view, tiles, result);
}
void cast_colours_by_eight(Exposure& exposure, Rendering& result) { cast_colours<8>(exposure, result); }
#endif

Rendering cast_middle(const View& view, const TileLists& tiles, int lanes) {
  Rendering result;
  result.depth.create(tiles.height, tiles.width, CV_32FC1);
  result.id.create(tiles.height, tiles.width, CV_16UC1);
  if (lanes == 8)
    cast_pixels_by_eight(view, tiles, result);
  else
    cast_pixels<4>(view, tiles, result);
  return result;
}

}  // namespace

Rendering cast_depth(const Scene& scene, const Camera& camera, const Instant& middle, int lanes) {
  const View view(scene, camera, middle);
  return cast_middle(view, TileLists(view, camera), lanes);
}

Rendering cast_frame(const Scene& scene, const Camera& camera, const Instant& middle,
                     std::span<const Instant> exposure, double blur_px, int lanes) {
  const View view(scene, camera, middle);
  const TileLists tiles(view, camera);
  Rendering result = cast_middle(view, tiles, lanes);
  result.colour.create(tiles.height, tiles.width, CV_32FC3);
  const int reach = std::max(1, static_cast<int>(std::ceil(blur_px / 2)) + 1);
  Exposure open{scene, tiles, {}, {}, reach, where_alone(result.id, reach)};
  for (const Instant& instant : exposure) open.views.emplace_back(scene, camera, instant);
  for (const View& seen : open.views) open.faces.emplace_back(scene, seen);
  if (lanes == 8)
    cast_colours_by_eight(open, result);
  else
    cast_colours<4>(open, result);
  return result;
}

}  // namespace stillpoint::generated
