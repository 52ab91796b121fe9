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

/// A face as it looks at one instant.
struct SeenFace {
  const Surface* surface = nullptr;
  const Texture* picture = nullptr;
  PictureFit fit;
  Vector3f normal;  ///< of flat ones, world
};

/// The faces of a view, each looked at when it is asked for first. Refers to the scene and the view.
class SeenFaces {
 public:
  SeenFaces(const Scene& scene, const View& view)
      : scene_(&scene), view_(&view), faces_(kMost * view.seen.size()) {}

  [[nodiscard]] const SeenFace& at(std::uint16_t id, int face) {
    SeenFace& seen = faces_[kMost * id + static_cast<std::size_t>(face)];
    if (seen.surface == nullptr) look(id, face, seen);
    return seen;
  }

 private:
  static constexpr std::size_t kMost = 6;  // faces of a primitive: a box has the most
  void look(std::uint16_t id, int face, SeenFace& seen) const;
  const Scene* scene_;
  const View* view_;
  std::vector<SeenFace> faces_;
};

/// The part of an image in which a primitive may show, px, and its least depth, m.
struct ImageBounds {
  float left = 1e9f, right = -1e9f, up = 1e9f, down = -1e9f, nearest = 1e9f;
  bool is_clipped = false;  ///< it reaches behind the camera, and may show beyond these sides

  /// Whether pixels `first` to `last` of a row may show it.
  [[nodiscard]] bool reach(float first, float last, float y) const {
    constexpr float kMargin = 2;  // px: samples of a pixel and bounds in single precision reach over a side
    return is_clipped ||
           (first <= right + kMargin && last >= left - kMargin && y <= down + kMargin && y >= up - kMargin);
  }
};

/// A primitive that may show in a tile.
struct Candidate {
  ImageBounds bounds;
  std::uint16_t id;
};

/// For each tile of the image, the primitives that may show in it, nearest first. The room is in every list.
struct TileLists {
  static constexpr int kSide = 16;  // px of a tile: its list is short, and there are few tiles
  TileLists(const View& view, const Camera& camera);

  [[nodiscard]] std::span<const Candidate> at(int x, int y) const {
    return lists[static_cast<std::size_t>(y / kSide * columns + x / kSide)];
  }

  int width, height, columns;
  std::vector<std::vector<Candidate>> lists;
};

}  // namespace stillpoint::generated
