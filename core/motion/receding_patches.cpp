#include "core/motion/receding_patches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/motion/carrier.hpp"

namespace stillpoint {
namespace {

constexpr int kMinPixels = 12;         // of a patch that meet the nearer surface
constexpr float kFarthest = 0.5F;      // m: a step longer than this shows another surface
constexpr double kLeastSigmas = 3.0;   // of depth: a shorter step is for patches that can be followed
constexpr double kShape = 2.0;         // standard deviations of depth by which steps of one shape may spread
constexpr double kMinTexture = 3.0;    // grey levels, standard deviation: less is plain
constexpr double kUnexplained = 0.35;  // share of its texture by which the same surface may look different
constexpr int kSideways = 4;           // px, to all sides: how far a patch may have gone beside
constexpr double kTypicalStep = 0.1;   // m
constexpr double kSurest = 20.0;       // log-odds: looks may deceive

/// Steps of the pixels of one patch.
struct Steps {
  double n = 0, sum = 0, squares = 0;
  [[nodiscard]] double mean() const { return sum / n; }
  [[nodiscard]] double spread() const { return std::sqrt(std::max(0.0, squares / n - mean() * mean())); }
};

/// A pixel of a patch, and where it was seen if the patch went back along the optical axis alone.
struct Seen {
  float gray, slope_x, slope_y;  // grey levels, and a pixel
  float u, v;                    // px, reference
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

Looks compare(const std::vector<Seen>& pixels, const cv::Mat& gray, int du, int dv) {
  const auto right = static_cast<float>(gray.cols - 1), bottom = static_cast<float>(gray.rows - 1);
  Looks s;
  for (const Seen& p : pixels) {
    const float u = p.u + static_cast<float>(du), v = p.v + static_cast<float>(dv);
    if (!(u >= 0 && v >= 0 && u < right && v < bottom)) continue;
    const double b = p.gray - bilinear(gray, u, v), gx = p.slope_x, gy = p.slope_y;
    s.n += 1, s.b += b, s.bb += b * b, s.gx += gx, s.gy += gy;
    s.gxx += gx * gx, s.gxy += gx * gy, s.gyy += gy * gy, s.gxb += gx * b, s.gyb += gy * b;
  }
  return s;
}

/// Whether the patch looks as it did somewhere about its place there, for it may have gone sideways too: what
/// is left of its differences is a small part of its texture.
bool looks_the_same(const std::vector<Seen>& pixels, const cv::Mat& gray) {
  double sum = 0, squares = 0;
  for (const Seen& p : pixels) sum += p.gray, squares += double{p.gray} * p.gray;
  const auto n = static_cast<double>(pixels.size());
  const double texture = (squares - sum * sum / n) / n;  // variance
  if (n < kMinPixels || texture < kMinTexture * kMinTexture) return false;
  Looks best;
  double least = std::numeric_limits<double>::max();
  for (int dv = -kSideways; dv <= kSideways; ++dv)
    for (int du = -kSideways; du <= kSideways; ++du) {
      const Looks looks = compare(pixels, gray, du, dv);
      if (looks.n < kMinPixels || 2 * looks.n < n || looks.left() / looks.n >= least) continue;
      best = looks, least = looks.left() / looks.n;
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
                -s.mean() > kLeastSigmas * sigma && s.spread() < kShape * sigma + 0.05 * -s.mean();
  }
  if (std::none_of(chosen.begin(), chosen.end(), [](std::uint8_t c) { return c != 0; })) return;

  std::vector<std::vector<Seen>> seen(patches.size());
  const auto cx = static_cast<float>(current.camera.cx), cy = static_cast<float>(current.camera.cy);
  for_pixels_of(
      chosen, current, labels, reference_from_current,
      [&](std::size_t patch, int x, int y, const Carrier& carried) {
        const float z = carried.z(x), farther = z / (z + static_cast<float>(steps[patch].mean()));
        seen[patch].push_back({current.gray.ptr<float>(y)[x], 2 * current.slope_x.ptr<float>(y)[x],
                               2 * current.slope_y.ptr<float>(y)[x], cx + (carried.u(x) - cx) * farther,
                               cy + (carried.v(x) - cy) * farther});
      });
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (chosen[i] == 0 || !looks_the_same(seen[i], reference.gray)) continue;
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
