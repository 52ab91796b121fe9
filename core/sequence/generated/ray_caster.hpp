#pragma once

#include <opencv2/core.hpp>
#include <span>

#include "core/sequence/generated/lanes.hpp"
#include "core/sequence/generated/scene.hpp"

namespace stillpoint::generated {

/// What an ideal camera sees.
struct Rendering {
  cv::Mat colour;  ///< CV_32FC3 BGR, 0 to 255 and beyond where it glares; empty when not asked for
  cv::Mat depth;   ///< CV_32FC1, m, at the middle of the exposure
  cv::Mat id;      ///< CV_16UC1: scene.fixed first, then the dynamic objects
};

// `lanes` is how many rays are cast at once, 4 or 8: the bytes do not depend on it.

/// Depth and ids alone, at one instant. Depth is 1e9 m where a ray meets nothing.
[[nodiscard]] Rendering cast_depth(const Scene& scene, const Camera& camera, const Instant& middle,
                                   int lanes = most_lanes());

/// Depth and ids at `middle`, colour averaged over the exposure's instants: each gives every pixel one sample
/// at its own place within the pixel, so that edges are smooth and what is dynamic is blurred by how it truly
/// moves.
/// @param blur_px no surface moves farther than this in the image during the exposure.
[[nodiscard]] Rendering cast_frame(const Scene& scene, const Camera& camera, const Instant& middle,
                                   std::span<const Instant> exposure, double blur_px,
                                   int lanes = most_lanes());

}  // namespace stillpoint::generated
