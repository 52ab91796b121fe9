#include "core/motion/stillpoint/axial_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core/hal/intrin.hpp>

#include "core/geometry/normal_equations.hpp"
#include "core/motion/stillpoint/depth_warp.hpp"
#include "core/motion/stillpoint/superpixel_motion.hpp"

namespace stillpoint {
namespace {

constexpr int kFewestMeasured = 12;   // of a superpixel, for each of the tests
constexpr float kFarthest = 0.5F;     // m: a step longer than this shows another surface
constexpr double kLeastSigmas = 3.0;  // of depth: a shorter step is for superpixels that can be followed
constexpr double kShape = 2.0;     // standard deviations of depth by which steps of one shape may spread …
constexpr double kLeaning = 0.05;  // … and this share of the step: for what turns as it goes
constexpr double kMinTexture = 3.0;      // grey levels, standard deviation: less is plain
constexpr double kUnexplained = 0.35;    // share of its texture by which the same surface may look different
constexpr int kSideways = 4;             // px, to all sides: how far a superpixel may have gone beside
constexpr double kSamePatchDepth = 4.0;  // standard deviations within which the nearer surface lies there
// What a dynamic object typically goes along the axis between the frames compared.
constexpr double kTypicalAxialStep = 0.1;  // m
constexpr double kSurest = 20.0;           // log-odds: looks may deceive

/// Steps of the pixels of one superpixel.
struct Steps {
  double n = 0, sum = 0, squares = 0;
  [[nodiscard]] double mean() const { return sum / n; }
  [[nodiscard]] double spread() const { return std::sqrt(std::max(0.0, squares / n - mean() * mean())); }
};

/// A pixel of a superpixel, and where and how far away it was seen then.
struct Seen {
  float gray, slope_x, slope_y;  // grey levels, and a pixel
  float u, v;                    // px, reference, had it gone straight along its ray
  float along_u, along_v;        // … and had it gone along the optical axis
  float z;                       // m
};

/// Calls `visit(superpixel, x, y, carrier)` for the pixels of the chosen superpixels that lie within their
/// surface.
template <typename Visit>
void for_pixels_of(const std::vector<std::uint8_t>& chosen, const RgbdView& current, const cv::Mat& labels,
                   const Pose& reference_from_current, const Visit& visit) {
  DepthWarp warped(current.camera, reference_from_current);
  for (int y = 1; y + 1 < labels.rows; ++y) {
    const auto* label = labels.ptr<int>(y);
    const auto* surface = current.surface.ptr<cv::Vec4f>(y);
    bool any = false;
    for (int x = 1; x + 1 < labels.cols && !any; ++x)
      any = label[x] >= 0 && chosen[static_cast<std::size_t>(label[x])] != 0;
    if (!any) continue;
    warped.warp_row(y, current.depth.ptr<float>(y));
    for (int x = 1; x + 1 < labels.cols; ++x)
      if (label[x] >= 0 && chosen[static_cast<std::size_t>(label[x])] != 0 && surface[x][3] > 0 &&
          warped.inside(x))
        visit(static_cast<std::size_t>(label[x]), x, y, warped);
  }
}

/// Where between the two ways a superpixel may have gone it is looked for: 0 its ray, 1 the axis.
cv::Point2f place_of(const Seen& p, float share) {
  return {p.u + share * (p.along_u - p.u), p.v + share * (p.along_v - p.v)};
}

float depth_tolerance(const Seen& p, const DepthNoise& noise) {
  return static_cast<float>(kSamePatchDepth) * noise.sigma(p.z);
}

/// The reference, padded so that every shift of a pixel within reach reads valid memory; the rim has no
/// depth, so that what lies in it never meets a surface.
struct Rimmed {
  explicit Rimmed(const RgbdView& view) : size(view.gray.size()), noise(depth_noise(view)) {
    cv::copyMakeBorder(view.gray, gray, kRim, kRim, kRim, kRim, cv::BORDER_REPLICATE);
    cv::copyMakeBorder(view.depth, depth, kRim, kRim, kRim, kRim, cv::BORDER_CONSTANT, cv::Scalar(0));
  }

  /// Whether any shift of a pixel at p lies in the reference.
  [[nodiscard]] bool reaches(const cv::Point2f& p) const {
    return p.x >= -kSideways && p.y >= -kSideways && p.x < static_cast<float>(size.width + kSideways) &&
           p.y < static_cast<float>(size.height + kSideways);
  }

  static constexpr int kLanes = cv::v_float32x4::nlanes;
  static constexpr int kShifts = 2 * kSideways + 1;                         // to one side and the other
  static constexpr int kPadded = (kShifts + kLanes - 1) / kLanes * kLanes;  // of a row of shifts
  // So broad, in px, that every shift of a pixel of the image lies inside, lanes beyond the last one too.
  static constexpr int kRim = kPadded + kSideways + 1;

  cv::Size size;  // without the rim
  DepthNoise noise;
  cv::Mat gray, depth;
};

/// Of each shift: how many of a superpixel's pixels meet its surface, their differences of brightness,
/// summed, and the squares.
class Shifts {
 public:
  static constexpr auto kAll = static_cast<std::size_t>(Rimmed::kShifts * Rimmed::kPadded);

  /// Lays a pixel onto all places about the one given.
  void add(const Seen& p, const cv::Point2f& at, const Rimmed& then) {
    const int x = cvFloor(at.x), y = cvFloor(at.y);
    const float right = at.x - static_cast<float>(x), down = at.y - static_cast<float>(y);
    const cv::v_float32x4 w00 = cv::v_setall_f32((1 - right) * (1 - down)),
                          w01 = cv::v_setall_f32(right * (1 - down)),
                          w10 = cv::v_setall_f32((1 - right) * down), w11 = cv::v_setall_f32(right * down);
    const cv::v_float32x4 gray = cv::v_setall_f32(p.gray), depth = cv::v_setall_f32(p.z),
                          tolerance = cv::v_setall_f32(depth_tolerance(p, then.noise)),
                          one = cv::v_setall_f32(1.0F), none = cv::v_setzero_f32();
    constexpr int kFirst = Rimmed::kRim - kSideways;
    const int nearest_x = cvRound(at.x) + kFirst, nearest_y = cvRound(at.y) + kFirst;
    float* sums = sums_.data();
    for (int row = 0; row < Rimmed::kShifts; ++row) {
      const float *above = then.gray.ptr<float>(y + kFirst + row) + x + kFirst,
                  *below = then.gray.ptr<float>(y + kFirst + row + 1) + x + kFirst,
                  *z = then.depth.ptr<float>(nearest_y + row) + nearest_x;
      for (int i = 0; i < Rimmed::kPadded; i += Rimmed::kLanes, sums += 3 * Rimmed::kLanes) {
        const cv::v_float32x4 then_gray = w00 * cv::v_load(above + i) + w01 * cv::v_load(above + i + 1) +
                                          w10 * cv::v_load(below + i) + w11 * cv::v_load(below + i + 1);
        const cv::v_float32x4 there = cv::v_load(z + i);
        const cv::v_float32x4 meets = (there > none) & (cv::v_abs(there - depth) <= tolerance);
        const cv::v_float32x4 b = meets & (gray - then_gray);
        cv::v_store(sums, cv::v_load(sums) + (meets & one));
        cv::v_store(sums + Rimmed::kLanes, cv::v_load(sums + Rimmed::kLanes) + b);
        cv::v_store(sums + 2 * Rimmed::kLanes, cv::v_load(sums + 2 * Rimmed::kLanes) + b * b);
      }
    }
  }

  /// The shift at which the least is left a pixel, of those at which at least half of the pixels meet the
  /// surface.
  struct Best {
    int du = 0, dv = 0;
    float left = std::numeric_limits<float>::max();  // squared grey levels a pixel
  };
  [[nodiscard]] Best best(std::size_t pixels) const {
    Best best;
    const float fewest = std::max(static_cast<float>(kFewestMeasured), 0.5F * static_cast<float>(pixels));
    for (int dv = -kSideways; dv <= kSideways; ++dv)
      for (int du = -kSideways; du <= kSideways; ++du) {
        const int column = du + kSideways, block = column / Rimmed::kLanes;
        const std::size_t at =
            3 * static_cast<std::size_t>((dv + kSideways) * Rimmed::kPadded + block * Rimmed::kLanes) +
            static_cast<std::size_t>(column % Rimmed::kLanes);
        const float n = sums_[at], b = sums_[at + Rimmed::kLanes], bb = sums_[at + 2 * Rimmed::kLanes];
        if (n < fewest) continue;
        const float left = (bb - b * b / n) / n;
        if (left < best.left) best = {du, dv, left};
      }
    return best;
  }

 private:
  std::array<float, 3 * kAll> sums_{};  // by row of shifts, block of lanes, count/difference/square, lane
};

/// How well a superpixel's brightness is met, shifted: what is left of its differences, squared, and their
/// sums.
struct Looks {
  double n = 0, b = 0, bb = 0, gx = 0, gy = 0, gxx = 0, gxy = 0, gyy = 0, gxb = 0, gyb = 0;
  [[nodiscard]] double left() const { return bb - b * b / n; }
};

Looks compare(const std::vector<Seen>& pixels, const RgbdView& then, float share, int du, int dv) {
  const auto right = static_cast<float>(then.gray.cols - 1), bottom = static_cast<float>(then.gray.rows - 1);
  const DepthNoise noise = depth_noise(then);
  Looks s;
  for (const Seen& p : pixels) {
    const cv::Point2f at = place_of(p, share) + cv::Point2f(static_cast<float>(du), static_cast<float>(dv));
    if (!(at.x >= 0 && at.y >= 0 && at.x < right && at.y < bottom)) continue;
    const float z = then.depth.ptr<float>(cvRound(at.y))[cvRound(at.x)];
    if (z <= 0 || std::abs(z - p.z) > depth_tolerance(p, noise)) continue;
    const double b = p.gray - bilinear(then.gray, at.x, at.y), gx = p.slope_x, gy = p.slope_y;
    s.n += 1, s.b += b, s.bb += b * b, s.gx += gx, s.gy += gy;
    s.gxx += gx * gx, s.gxy += gx * gy, s.gyy += gy * gy, s.gxb += gx * b, s.gyb += gy * b;
  }
  return s;
}

/// Squared grey levels a pixel that a superpixel's brightness bends by, a ramp taken off: shading is no
/// texture.
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
  return std::max(0.0, squares - g.dot(solve_ldlt(h, g))) / static_cast<double>(pixels.size());
}

/// Whether the superpixel looks as it did somewhere about where it must have been, for it may have gone
/// sideways too: what is left of its differences is a small part of its texture.
bool looks_the_same(const std::vector<Seen>& pixels, const RgbdView& then, const Rimmed& rimmed) {
  if (pixels.size() < kFewestMeasured) return false;
  const double texture = texture_of(pixels);
  if (texture < kMinTexture * kMinTexture) return false;
  Shifts::Best place;
  float best_share = 0.0F;
  for (const float share : {1.0F, 0.0F}) {
    Shifts shifts;
    for (const Seen& p : pixels)
      if (const cv::Point2f at = place_of(p, share); rimmed.reaches(at)) shifts.add(p, at, rimmed);
    const Shifts::Best found = shifts.best(pixels.size());
    if (found.left < place.left) place = found, best_share = share;
  }
  if (place.left == std::numeric_limits<float>::max()) return false;
  const Looks best = compare(pixels, then, best_share, place.du, place.dv);
  if (best.n < kFewestMeasured || 2 * best.n < static_cast<double>(pixels.size())) return false;
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

void measure_axial_motion(const RgbdView& current, const RgbdView& reference,
                          const Pose& reference_from_current, const cv::Mat& labels,
                          const std::vector<Superpixel>& superpixels, double noise_floor,
                          std::vector<SuperpixelMotion>& motions) {
  std::vector<std::uint8_t> chosen(motions.size());
  for (std::size_t i = 0; i < superpixels.size(); ++i) chosen[i] = motions[i].log_odds == 0.0F;
  std::vector<Steps> steps(superpixels.size());
  const DepthNoise noise = depth_noise(current);
  const auto* then = reference.depth.ptr<float>();
  for_pixels_of(chosen, current, labels, reference_from_current,
                [&](std::size_t superpixel, int x, int, const DepthWarp& warped) {
                  const float there = warped.at(then, x), step = there - warped.z(x);
                  if (there <= 0 || step > 0 || step < -kFarthest) return;
                  Steps& s = steps[superpixel];
                  s.n += 1, s.sum += step, s.squares += step * step;
                });
  for (std::size_t i = 0; i < superpixels.size(); ++i) {
    const Steps& s = steps[i];
    const double sigma = noise.sigma(superpixels[i].depth);
    chosen[i] = chosen[i] != 0 && s.n >= kFewestMeasured && 2 * s.n > superpixels[i].pixels &&
                -s.mean() > kLeastSigmas * sigma && s.spread() < kShape * sigma + kLeaning * -s.mean();
  }
  if (std::none_of(chosen.begin(), chosen.end(), [](std::uint8_t c) { return c != 0; })) return;

  std::vector<std::vector<Seen>> seen(superpixels.size());
  const auto cx = static_cast<float>(current.camera.cx), cy = static_cast<float>(current.camera.cy);
  for_pixels_of(chosen, current, labels, reference_from_current,
                [&](std::size_t superpixel, int x, int y, const DepthWarp& warped) {
                  const float u = warped.u(x), v = warped.v(x),
                              z = warped.z(x) + static_cast<float>(steps[superpixel].mean());
                  const float farther = warped.z(x) / z;
                  const cv::Vec4f& here = current.surface.ptr<cv::Vec4f>(y)[x];
                  seen[superpixel].push_back({here[2], 2 * here[0], 2 * here[1], u, v,
                                              cx + (u - cx) * farther, cy + (v - cy) * farther, z});
                });
  const Rimmed rimmed(reference);
  for (std::size_t i = 0; i < superpixels.size(); ++i) {
    if (chosen[i] == 0 || !looks_the_same(seen[i], reference, rimmed)) continue;
    const double sigma = noise.sigma(superpixels[i].depth), step = steps[i].mean();
    const double still = 9.0 * sigma * sigma / steps[i].n + noise_floor * noise_floor;
    motions[i] = {{0.0F, 0.0F},
                  static_cast<float>(step),
                  static_cast<float>(std::min(kSurest, step_log_odds(step, still, kTypicalAxialStep)))};
  }
}

}  // namespace stillpoint
