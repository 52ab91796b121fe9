#include "core/sequence/generated/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>

namespace stillpoint::generated {
namespace {

constexpr double kLensBlur = 0.6;                     // px, deviation: the lens and the colour mosaic
constexpr float kBase = 0.075f;                       // m between projector and depth camera
constexpr float kSteps = 8.0f;                        // disparity steps a pixel
constexpr float kMinDepth = 0.45f, kMaxDepth = 6.0f;  // m: a Kinect measures little nearer or farther
constexpr float kSteepest = 6.0f;  // depth gained a metre across, beyond which nothing comes back
constexpr float kEdge = 0.04f;     // relative depth step that makes an outline

std::uint32_t u32(int i) { return static_cast<std::uint32_t>(i); }

/// Noise at the node of a lattice.
float node(std::uint32_t key, int i, int j) { return gaussian(hash(key, u32(i), u32(j))); }

/// Value noise on a lattice of `pitch` px: what neighbouring pixels share.
float lattice(std::uint32_t key, int x, int y, int pitch) {
  const int i = x / pitch, j = y / pitch;
  const float a = (static_cast<float>(x % pitch) + 0.5f) / static_cast<float>(pitch);
  const float b = (static_cast<float>(y % pitch) + 0.5f) / static_cast<float>(pitch);
  return (node(key, i, j) * (1 - a) + node(key, i + 1, j) * a) * (1 - b) +
         (node(key, i, j + 1) * (1 - a) + node(key, i + 1, j + 1) * a) * b;
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

/// A row of pixels as the colour sensor reads it.
struct ColourRow {
  const float* ideal;                // 3 values a pixel
  std::uint8_t* read;                // the same
  int width;                         // px
  std::uint32_t seed, frame, first;  // of its noise; the number of its first pixel in the image
  float gain, reach, dy;             // of exposure and vignetting
};

template <int N>
STILLPOINT_PACKET void read_pixels(const ColourRow& row, int x) {
  const Floats<N> dx = counted_from<N>(static_cast<float>(x)) - 0.5f * static_cast<float>(row.width);
  const Floats<N> factor = row.gain * (1.0f - 0.16f * (dx * dx + row.dy * row.dy) * row.reach);
  const Bits<N> number = counted_from<N>(row.first + u32(x));
  const Bits<N> bits =
      hash<N>(broadcast<N>(row.seed), broadcast<N>(row.frame), number, broadcast<N>(std::uint32_t{2}));
  const Floats<N> shared = gaussian<N>(bits);
  for (int c = 0; c < 3; ++c) {
    const float* ideal = row.ideal + 3 * x + c;
    Floats<N> value;
    for (int i = 0; i < N; ++i) value[i] = ideal[3 * i];
    value *= factor;
    const Floats<N> sigma =
        1.3f + 0.0075f * lesser<N>(value, broadcast<N>(255.0f));  // dark current, then photons
    const Floats<N> own = gaussian<N>(hash<N>(bits, broadcast<N>(u32(c))));
    const Floats<N> noisy = value + sigma * (0.75f * shared + 0.65f * own);
    const Ints<N> level =
        truncated<N>(lesser<N>(greater<N>(noisy + 0.5f, Floats<N>{}), broadcast<N>(255.0f)));
    std::uint8_t* read = row.read + 3 * x + c;
    for (int i = 0; i < N; ++i) read[3 * i] = static_cast<std::uint8_t>(level[i]);
  }
}

/// A row of pixels as the depth camera measures it where it measures anything.
struct DepthRow {
  const float* ideal;         // m
  const float* shared_noise;  // of neighbouring pixels, mean 0
  float* stored;              // in units of the depth image, before it is cut to a whole number
  int width, y;               // px
  std::uint32_t key;          // of its noise
  float focal, scale;         // px; units of the depth image a metre
};

template <int N>
STILLPOINT_PACKET void measure_pixels(const DepthRow& row, int x) {
  Floats<N> z, shared;
  std::memcpy(&z, row.ideal + x, sizeof z);
  std::memcpy(&shared, row.shared_noise + x, sizeof shared);
  // Beyond these limits nothing is measured.
  z = lesser<N>(greater<N>(z, broadcast<N>(kMinDepth)), broadcast<N>(kMaxDepth));
  const Bits<N> bits = hash<N>(broadcast<N>(row.key), counted_from<N>(u32(x)), broadcast<N>(u32(row.y)));
  const Floats<N> away = z - 0.4f;
  const Floats<N> sigma = 0.0012f + 0.0019f * away * away;
  const Floats<N> noise =
      0.8f * gaussian<N>(hash<N>(bits, broadcast<N>(std::uint32_t{6}))) + 0.6f * 1.5f * shared;
  const Floats<N> steps = kSteps * row.focal * kBase / (z + sigma * noise);
  const Floats<N> whole = to_floats<N>(truncated<N>(steps));
  const Floats<N> disparity = (steps - whole >= 0.5f ? whole + 1.0f : whole) / kSteps;
  const Floats<N> stored = row.focal * kBase / disparity * row.scale + 0.5f;
  std::memcpy(row.stored + x, &stored, sizeof stored);
}

template <int N>
STILLPOINT_PACKET void read_row(const ColourRow& row) {
  int x = 0;
  for (; x + N <= row.width; x += N) read_pixels<N>(row, x);
  for (; x < row.width; ++x) read_pixels<1>(row, x);
}
template <int N>
STILLPOINT_PACKET void measure_row(const DepthRow& row) {
  int x = 0;
  for (; x + N <= row.width; x += N) measure_pixels<N>(row, x);
  for (; x < row.width; ++x) measure_pixels<1>(row, x);
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void read_row_by_eight(const ColourRow& row) { read_row<8>(row); }
[[gnu::target("avx2")]] void measure_row_by_eight(const DepthRow& row) { measure_row<8>(row); }
#else
void read_row_by_eight(const ColourRow& row) { read_row<8>(row); }
void measure_row_by_eight(const DepthRow& row) { measure_row<8>(row); }
#endif
void read_row_by_four(const ColourRow& row) { read_row<4>(row); }
void measure_row_by_four(const DepthRow& row) { measure_row<4>(row); }

/// Value noise on a lattice of 4 px along a row, as lattice() has it.
void draw_lattice(std::uint32_t key, int y, std::vector<float>& row) {
  constexpr int kPitch = 4;  // px between the lattice's nodes
  const int j = y / kPitch, width = static_cast<int>(row.size());
  const float b = (static_cast<float>(y % kPitch) + 0.5f) / static_cast<float>(kPitch);
  float above = node(key, 0, j), below = node(key, 0, j + 1);
  for (int x = 0; x < width; x += kPitch) {
    const float next_above = node(key, x / kPitch + 1, j), next_below = node(key, x / kPitch + 1, j + 1);
    for (int k = 0; k < std::min(kPitch, width - x); ++k) {
      const float a = (static_cast<float>(k) + 0.5f) / static_cast<float>(kPitch);
      row[static_cast<std::size_t>(x + k)] =
          (above * (1 - a) + next_above * a) * (1 - b) + (below * (1 - a) + next_below * a) * b;
    }
    above = next_above, below = next_below;
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
  const auto read_row = most_lanes() == 8 ? read_row_by_eight : read_row_by_four;
  for (int y = 0; y < ideal.rows; ++y)
    read_row({ideal.ptr<float>(y), image.ptr(y), ideal.cols, seed_, u32(frame), u32(y * ideal.cols), gain,
              reach, static_cast<float>(y) - middle_y});
  return image;
}

cv::Mat Sensor::depth(const Rendering& ideal, const std::vector<float>& dropout, const Camera& camera,
                      int frame) const {
  const int width = ideal.depth.cols, height = ideal.depth.rows;
  cv::Mat result(height, width, CV_16UC1, cv::Scalar(0));
  const float focal = static_cast<float>(camera.fx);
  std::vector<std::uint8_t> hole(static_cast<std::size_t>(width));
  std::vector<float> measured(hole.size()), shared(hole.size());
  const auto measure_row = most_lanes() == 8 ? measure_row_by_eight : measure_row_by_four;
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
    draw_lattice(key, y, shared);
    measure_row(
        {row, shared.data(), measured.data(), width, y, key, focal, static_cast<float>(camera.depth_scale)});
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
      if (!outline && step * focal > kSteepest * z * 0.7f &&
          step * focal > kSteepest * z * (0.7f + 0.6f * uniform(hash(bits, 5u))))
        continue;
      const float lost = dropout[id[x]];
      if (lost > 0 && 0.5f + 0.4f * lattice(patches, x, y, 7) + 0.12f * lattice(patches + 1u, x, y, 2) < lost)
        continue;
      const float stored = measured[static_cast<std::size_t>(x)];
      if (stored > 0 && stored < 65535.0f) out[x] = static_cast<std::uint16_t>(stored);
    }
  }
  return result;
}

}  // namespace stillpoint::generated
