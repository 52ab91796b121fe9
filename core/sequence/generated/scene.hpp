#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/sequence/generated/primitives.hpp"

namespace stillpoint::generated {

// World coordinates: z up, floor at z = 0, x to the right and y away from the first camera; metres.

/// Where the light comes from (unit vector, world).
[[nodiscard]] inline Vector3f light_direction() { return Vector3f(0.38f, -0.5f, 0.78f); }

/// A soft round shadow on the floor, under someone.
struct Blob {
  Vector2f centre;  ///< m
  float radius;     ///< m
  float strength;   ///< 0 to 1, light taken away in the middle
};

/// The shadow that furniture throws on a level surface: floor or table top.
struct ShadowPlane {
  float height = 0;       ///< z of the surface, m
  Vector2f corner{0, 0};  ///< smallest x and y, m
  float texels_per_metre = 100;
  cv::Mat light;  ///< CV_8UC1, 255 = lit
};

/// What is static.
struct Scene {
  std::vector<Texture> pictures;
  std::vector<Surface> surfaces;
  std::vector<Primitive> fixed;  ///< the first is the room itself, and encloses all
  std::vector<ShadowPlane> planes;

  /// Adds a surface and returns its index.
  std::uint16_t add(const Surface& surface);
};

/// Computes where the fixed primitives keep the light off the plane.
[[nodiscard]] ShadowPlane cast_shadows(const std::vector<Primitive>& fixed, float height,
                                       const Vector2f& corner, const Vector2f& size, float blur_m);

/// What is dynamic, at one instant. Every instant of a sequence lists the same primitives in the same order.
struct Instant {
  Pose world_from_camera = Pose::Identity();
  std::vector<Primitive> actors;
  std::vector<Blob> blobs;
};

}  // namespace stillpoint::generated
