#include "core/sequence/generated/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace stillpoint::generated {
namespace {

constexpr double kLensBlur = 0.6;                     // px, deviation: the lens and the colour mosaic
constexpr float kBase = 0.075f;                       // m between projector and depth camera
constexpr float kSteps = 8.0f;                        // disparity steps a pixel
constexpr float kMinDepth = 0.45f, kMaxDepth = 6.0f;  // m
constexpr float kSteepest = 6.0f;  // depth gained a metre across, beyond which nothing comes back
constexpr float kEdge = 0.04f;     // relative depth step that makes an outline

std::uint32_t u32(int i) { return static_cast<std::uint32_t>(i); }

/// Value noise on a lattice of `pitch` px: what neighbouring pixels share.
float lattice(std::uint32_t key, int x, int y, int pitch) {
  const int i = x / pitch, j = y / pitch;
  const float a = (static_cast<float>(x % pitch) + 0.5f) / static_cast<float>(pitch);
  const float b = (static_cast<float>(y % pitch) + 0.5f) / static_cast<float>(pitch);
  const auto at = [&](int u, int v) { return gaussian(hash(key, u32(u), u32(v))); };
  return (at(i, j) * (1 - a) + at(i + 1, j) * a) * (1 - b) +
         (at(i, j + 1) * (1 - a) + at(i + 1, j + 1) * a) * b;
}

/// Marks what the projector, to the camera's right, cannot light: there the order of columns is turned round.
void mark_projector_shadow(const float* depth, int width, float focal, std::uint8_t* hole) {
  float leftmost = 1e9f;
  for (int x = width - 1; x >= 0; --x) {
    const float column = static_cast<float>(x) - focal * kBase / depth[x];
    if (column > leftmost + 0.8f) hole[x] = 1;
    leftmost = std::min(leftmost, column);
  }
}

}  // namespace

Sensor::Sensor(unsigned seed) : seed_(hash(seed, 0x5E45u)) {
  Dice dice(seed_);
  exposure_ = Wander(dice, 0.02, 0.05, 0.4, 3);
}

cv::Mat Sensor::colour(const cv::Mat& perfect, int frame, double seconds) const {
  cv::Mat ideal, image(perfect.size(), CV_8UC3);
  cv::GaussianBlur(perfect, ideal, {3, 3}, kLensBlur);
  const float flicker = 0.006f * gaussian(hash(seed_, u32(frame), 1u));
  const float gain = 1.0f + static_cast<float>(exposure_.at(seconds)) + flicker;
  const float middle_x = 0.5f * static_cast<float>(ideal.cols),
              middle_y = 0.5f * static_cast<float>(ideal.rows);
  const float reach = 1.0f / (middle_x * middle_x + middle_y * middle_y);
  for (int y = 0; y < ideal.rows; ++y) {
    const auto* in = ideal.ptr<cv::Vec3f>(y);
    auto* out = image.ptr<cv::Vec3b>(y);
    const float dy = static_cast<float>(y) - middle_y;
    for (int x = 0; x < ideal.cols; ++x) {
      const float dx = static_cast<float>(x) - middle_x;
      const float factor = gain * (1.0f - 0.16f * (dx * dx + dy * dy) * reach);
      const std::uint32_t bits = hash(seed_, u32(frame), u32(y * ideal.cols + x), 2u);
      const float shared = gaussian(bits);
      for (int c = 0; c < 3; ++c) {
        const float value = in[x][c] * factor;
        const float sigma = 1.3f + 0.0075f * std::min(value, 255.0f);  // dark current, then photons
        const float own = gaussian(hash(bits, u32(c)));
        const float noisy = value + sigma * (0.75f * shared + 0.65f * own);
        out[x][c] = static_cast<std::uint8_t>(std::clamp(noisy + 0.5f, 0.0f, 255.0f));
      }
    }
  }
  return image;
}

cv::Mat Sensor::depth(const Rendering& ideal, const std::vector<float>& dropout, const Camera& camera,
                      int frame) const {
  const int width = ideal.depth.cols, height = ideal.depth.rows;
  cv::Mat result(height, width, CV_16UC1, cv::Scalar(0));
  const float focal = static_cast<float>(camera.fx);
  std::vector<std::uint8_t> hole(static_cast<std::size_t>(width));
  const std::uint32_t key = hash(seed_, u32(frame), 3u), patches = hash(seed_, u32(frame), 4u);
  // Registration to the colour camera leaves a margin without data.
  const int margin_x = 9, margin_y = 7;
  for (int y = margin_y; y < height - 2; ++y) {
    const float* row = ideal.depth.ptr<float>(y);
    const float* above = ideal.depth.ptr<float>(y - 1);
    const float* below = ideal.depth.ptr<float>(std::min(y + 1, height - 1));
    const auto* id = ideal.id.ptr<std::uint16_t>(y);
    auto* out = result.ptr<std::uint16_t>(y);
    std::fill(hole.begin(), hole.end(), std::uint8_t{0});
    mark_projector_shadow(row, width, focal, hole.data());
    for (int x = 3; x < width - margin_x; ++x) {
      const float z = row[x];
      if (hole[static_cast<std::size_t>(x)] || z < kMinDepth || z > kMaxDepth) continue;
      const float across = std::max(std::abs(row[x + 1] - z), std::abs(row[x - 1] - z));
      const float upright = std::max(std::abs(above[x] - z), std::abs(below[x] - z));
      const float step = std::max(across, upright);
      const std::uint32_t bits = hash(key, u32(x), u32(y));
      const bool outline = step > kEdge * z;
      if (outline && (bits & 3u) != 0) continue;
      // Off outlines a large step means a surface seen at a grazing angle.
      if (!outline && step * focal > kSteepest * z * (0.7f + 0.6f * uniform(hash(bits, 5u)))) continue;
      const float lost = dropout[id[x]];
      if (lost > 0 && 0.5f + 0.4f * lattice(patches, x, y, 7) + 0.12f * lattice(patches + 1u, x, y, 2) < lost)
        continue;
      const float away = z - 0.4f;
      const float sigma = 0.0012f + 0.0019f * away * away;
      const float noise = 0.8f * gaussian(hash(bits, 6u)) + 0.6f * 1.5f * lattice(key, x, y, 4);
      const float measured = z + sigma * noise;
      const float disparity = std::round(kSteps * focal * kBase / measured) / kSteps;
      const float stored = focal * kBase / disparity * static_cast<float>(camera.depth_scale) + 0.5f;
      if (stored > 0 && stored < 65535.0f) out[x] = static_cast<std::uint16_t>(stored);
    }
  }
  return result;
}

}  // namespace stillpoint::generated
