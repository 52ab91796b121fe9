#include "core/motion/receding_patches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/motion/carrier.hpp"

namespace stillpoint {
namespace {

constexpr int kMinPixels = 12;        // of a patch, for each of the tests
constexpr float kFarthest = 0.5F;     // m: a step longer than this shows another surface
constexpr double kLeastSigmas = 3.0;  // of depth: a shorter step is for patches that can be followed
constexpr double kShape = 2.0;     // standard deviations of depth by which steps of one shape may spread …
constexpr double kLeaning = 0.05;  // … and this share of the step: for what turns as it goes
constexpr double kMinTexture = 3.0;    // grey levels, standard deviation: less is plain
constexpr double kUnexplained = 0.35;  // share of its texture by which the same surface may look different
constexpr int kSideways = 4;           // px, to all sides: how far a patch may have gone beside
constexpr double kSameDepth = 4.0;     // standard deviations within which the nearer surface lies there
constexpr double kTypicalStep = 0.1;   // m
constexpr double kSurest = 20.0;       // log-odds: looks may deceive

/// Steps of the pixels of one patch.
struct Steps {
  double n = 0, sum = 0, squares = 0;
  [[nodiscard]] double mean() const { return sum / n; }
  [[nodiscard]] double spread() const { return std::sqrt(std::max(0.0, squares / n - mean() * mean())); }
};

/// A pixel of a patch, and where and how far away it was seen then.
struct Seen {
  float gray, slope_x, slope_y;  // grey levels, and a pixel
  float u, v;                    // px, reference, had it gone straight along its ray
  float along_u, along_v;        // … and had it gone along the optical axis
  float z;                       // m
};

/// Calls `visit(patch, x, y, carrier)` for the pixels of the chosen patches that lie within their surface.
template <typename Visit>
void for_pixels_of(const std::vector<std::uint8_t>& chosen, const RgbdView& current, const cv::Mat& labels,
                   const Pose& reference_from_current, const Visit& visit) {
  Carrier carried(current.camera, reference_from_current);
  for (int y = 1; y + 1 < labels.rows; ++y) {
    const auto* label = labels.ptr<int>(y);
    const auto* within = current.within_surface.ptr<uchar>(y);
    bool any = false;
    for (int x = 1; x + 1 < labels.cols && !any; ++x)
      any = label[x] >= 0 && chosen[static_cast<std::size_t>(label[x])] != 0;
    if (!any) continue;
    carried.carry_row(y, current.depth.ptr<float>(y));
    for (int x = 1; x + 1 < labels.cols; ++x)
      if (label[x] >= 0 && chosen[static_cast<std::size_t>(label[x])] != 0 && within[x] != 0 &&
          carried.inside(x))
        visit(static_cast<std::size_t>(label[x]), x, y, carried);
  }
}

/// How well a patch's brightness is met, shifted: what is left of its differences, squared, and their sums.
struct Looks {
  double n = 0, b = 0, bb = 0, gx = 0, gy = 0, gxx = 0, gxy = 0, gyy = 0, gxb = 0, gyb = 0;
  [[nodiscard]] double left() const { return bb - b * b / n; }
};

/// @param share where between the two ways a patch may have gone it is looked for: 0 its ray, 1 the axis
Looks compare(const std::vector<Seen>& pixels, const RgbdView& then, float share, int du, int dv) {
  const auto right = static_cast<float>(then.gray.cols - 1), bottom = static_cast<float>(then.gray.rows - 1);
  Looks s;
  for (const Seen& p : pixels) {
    const float u = p.u + share * (p.along_u - p.u) + static_cast<float>(du),
                v = p.v + share * (p.along_v - p.v) + static_cast<float>(dv);
    if (!(u >= 0 && v >= 0 && u < right && v < bottom)) continue;
    const float z = then.depth.ptr<float>(cvRound(v))[cvRound(u)];
    if (std::abs(z - p.z) > static_cast<float>(kSameDepth) * depth_sigma(p.z)) continue;
    const double b = p.gray - bilinear(then.gray, u, v), gx = p.slope_x, gy = p.slope_y;
    s.n += 1, s.b += b, s.bb += b * b, s.gx += gx, s.gy += gy;
    s.gxx += gx * gx, s.gxy += gx * gy, s.gyy += gy * gy, s.gxb += gx * b, s.gyb += gy * b;
  }
  return s;
}

/// Squared grey levels a pixel that a patch's brightness bends by, a ramp taken off: shading is no texture.
double texture_of(const std::vector<Seen>& pixels) {
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double squares = 0;
  for (const Seen& p : pixels) {
    const Eigen::Vector3d at(1.0, double{p.u} - pixels.front().u, double{p.v} - pixels.front().v);
    const double gray = double{p.gray} - pixels.front().gray;
    h += at * at.transpose();
    g += gray * at;
    squares += gray * gray;
  }
  return std::max(0.0, squares - g.dot(h.ldlt().solve(g))) / static_cast<double>(pixels.size());
}

/// Whether the patch looks as it did somewhere about where it must have been, for it may have gone sideways
/// too: what is left of its differences is a small part of its texture.
bool looks_the_same(const std::vector<Seen>& pixels, const RgbdView& then) {
  if (pixels.size() < kMinPixels) return false;
  const double texture = texture_of(pixels);
  if (texture < kMinTexture * kMinTexture) return false;
  Looks best;
  double least = std::numeric_limits<double>::max();
  for (const float share : {1.0F, 0.0F})
    for (int dv = -kSideways; dv <= kSideways; ++dv)
      for (int du = -kSideways; du <= kSideways; ++du) {
        const Looks looks = compare(pixels, then, share, du, dv);
        const bool enough = looks.n >= kMinPixels && 2 * looks.n >= static_cast<double>(pixels.size());
        if (enough && looks.left() / looks.n < least) best = looks, least = looks.left() / looks.n;
      }
  if (best.n < kMinPixels) return false;
  // The rest of a pixel is read off the slopes.
  Eigen::Matrix2d h;
  h << best.gxx - best.gx * best.gx / best.n, best.gxy - best.gx * best.gy / best.n, 0,
      best.gyy - best.gy * best.gy / best.n;
  h(1, 0) = h(0, 1);
  h.diagonal().array() += best.n;  // a grey level a pixel: no shift is read from noise
  const Eigen::Vector2d g(best.gxb - best.gx * best.b / best.n, best.gyb - best.gy * best.b / best.n);
  return best.left() - g.dot(h.inverse() * g) < kUnexplained * texture * best.n;
}

}  // namespace

void measure_receding(const RgbdView& current, const RgbdView& reference, const Pose& reference_from_current,
                      const cv::Mat& labels, const std::vector<Segment>& segments, double slack,
                      std::vector<PatchMotion>& patches) {
  std::vector<std::uint8_t> chosen(patches.size());
  for (std::size_t i = 0; i < patches.size(); ++i) chosen[i] = patches[i].log_odds == 0.0F;
  std::vector<Steps> steps(patches.size());
  for_pixels_of(chosen, current, labels, reference_from_current,
                [&](std::size_t patch, int x, int, const Carrier& carried) {
                  const int u = cvRound(carried.u(x)), v = cvRound(carried.v(x));
                  const float there = reference.depth.ptr<float>(v)[u], step = there - carried.z(x);
                  if (there <= 0 || step > 0 || step < -kFarthest) return;
                  Steps& s = steps[patch];
                  s.n += 1, s.sum += step, s.squares += step * step;
                });
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const Steps& s = steps[i];
    const double sigma = depth_sigma(segments[i].depth);
    chosen[i] = chosen[i] != 0 && s.n >= kMinPixels && 2 * s.n > segments[i].pixels &&
                -s.mean() > kLeastSigmas * sigma && s.spread() < kShape * sigma + kLeaning * -s.mean();
  }
  if (std::none_of(chosen.begin(), chosen.end(), [](std::uint8_t c) { return c != 0; })) return;

  std::vector<std::vector<Seen>> seen(patches.size());
  const auto cx = static_cast<float>(current.camera.cx), cy = static_cast<float>(current.camera.cy);
  for_pixels_of(chosen, current, labels, reference_from_current,
                [&](std::size_t patch, int x, int y, const Carrier& carried) {
                  const float u = carried.u(x), v = carried.v(x),
                              z = carried.z(x) + static_cast<float>(steps[patch].mean());
                  const float farther = carried.z(x) / z;
                  seen[patch].push_back({current.gray.ptr<float>(y)[x], 2 * current.slope_x.ptr<float>(y)[x],
                                         2 * current.slope_y.ptr<float>(y)[x], u, v, cx + (u - cx) * farther,
                                         cy + (v - cy) * farther, z});
                });
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (chosen[i] == 0 || !looks_the_same(seen[i], reference)) continue;
    const double sigma = depth_sigma(segments[i].depth), step = steps[i].mean();
    const double still = 9.0 * sigma * sigma / steps[i].n + slack * slack,
                 moved = still + kTypicalStep * kTypicalStep;
    patches[i] = {{0.0F, 0.0F},
                  static_cast<float>(step),
                  static_cast<float>(std::min(kSurest, 0.5 * step * step * (1.0 / still - 1.0 / moved) -
                                                           0.5 * std::log(moved / still)))};
  }
}

}  // namespace stillpoint
