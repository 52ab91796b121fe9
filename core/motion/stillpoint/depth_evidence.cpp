#include "core/motion/stillpoint/depth_evidence.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/median.hpp"
#include "core/motion/stillpoint/depth_warp.hpp"

namespace stillpoint {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr float kMinIntensitySigma = 2.0F;  // grey levels: no camera is better
// Log-odds a pixel gets from one reference.
constexpr float kSeenThrough = 1.2F;  // free space where the surface is now
constexpr float kStepsBack = 0.5F;    // a surface nearer by little: most likely the same one, moving off
constexpr float kSteppedBack = 0.1F;  // … less likely the same one, the longer ago
constexpr float kOtherBrightness = 0.6F;
constexpr float kSameDepth = -0.25F;     // weak: the middle of a dynamic object agrees with itself
constexpr float kTextured = 3.0F;        // standard deviations of noise that a textured pixel's gradient has
constexpr float kSameTexture = -0.4F;    // a textured pixel that looks the same is static
constexpr float kStepBackLimit = 0.15F;  // m: a surface farther off than this was another one

/// Of the nine measurements about a pixel, the one nearest to what is expected; 0 when there is none. Edges
/// lie a pixel off easily, and then the neighbour still has the surface.
float nearest_depth(const cv::Mat& depth, const cv::Point& at, float expected) {
  float best = 0.0F, best_difference = std::numeric_limits<float>::max();
  for (int dy = -1; dy <= 1; ++dy) {
    const float* row = depth.ptr<float>(at.y + dy) + at.x;
    for (int dx = -1; dx <= 1; ++dx) {
      const float difference = std::abs(row[dx] - expected);
      const bool better = (row[dx] > 0) & (difference < best_difference);
      best = better ? row[dx] : best;
      best_difference = better ? difference : best_difference;
    }
  }
  return best;
}

/// A pixel as it is expected in the reference, or a row of them.
struct Expected {
  const float* depth;  // m, there
  const float* here;   // m, as measured in the current view
  const float* slope;  // m a pixel, of its surface
  float off = 0.0F;    // px, registration_error()
  DepthNoise noise = kKinectNoise;
};

/// Measured less expected depth, in standard deviations of both and of where on a slanted surface the pixel
/// comes to lie; NaN where nothing was measured.
float depth_residual(float measured, const Expected& expected, int x) {
  const float a = expected.noise.sigma(expected.here[x]), b = expected.noise.sigma(measured),
              c = expected.off * expected.slope[x];
  return measured > 0 ? (measured - expected.depth[x]) / std::sqrt(a * a + b * b + c * c) : kUnknown;
}

/// By how much of a pixel slanted surfaces lie beside where they are expected: the pose is not exact, depth
/// and colour are of different moments, and rows are read one after the other. Of what is not in the prior to
/// move; a median, so that other dynamic objects do not count.
float registration_error(const RgbdView& current, const ReferenceView& reference, const cv::Mat& prior,
                         const StillpointConfig& config, bool wide) {
  constexpr int kEvery = 4;                  // rows: a quarter of the pixels tells a median as well
  constexpr std::size_t kFewest = 100;       // pixels: fewer tell no median of noise
  constexpr float kMedianOfSquare = 0.455F;  // of a standard normal variable
  constexpr float kRounding = 0.45F;         // px: what is left of going to the nearest pixel
  DepthWarp warped(current.camera, reference.reference_from_current, wide);
  const DepthNoise depth_noise = stillpoint::depth_noise(current);
  const auto* then = reference.view->depth.ptr<float>();
  std::vector<float> squares;  // px²
  for (int y = kEvery / 2; y < current.depth.rows; y += kEvery) {
    const auto *depth = current.depth.ptr<float>(y), *slope = current.depth_slope.ptr<float>(y),
               *known = prior.ptr<float>(y);
    warped.warp_row(y, depth);
    for (int x = 0; x < current.depth.cols; ++x) {
      if (!warped.inside(x) || known[x] > static_cast<float>(config.moving_log_odds)) continue;
      const float measured = warped.at(then, x);
      if (measured <= 0) continue;
      const float a = depth_noise.sigma(depth[x]), b = depth_noise.sigma(measured), noise = a * a + b * b;
      const float step = measured - warped.z(x), steep = slope[x] * slope[x];
      if (steep < noise || std::abs(step) > kStepBackLimit) continue;
      squares.push_back((step * step / kMedianOfSquare - noise) / steep);
    }
  }
  if (squares.size() < kFewest) return 0.0F;
  return std::clamp(std::sqrt(std::max(0.0F, median_of(squares))) - kRounding, 0.0F,
                    static_cast<float>(config.max_registration_error_px));
}

/// A row of the current view as it is compared with the reference.
struct ComparedRow {
  DepthWarp::WarpedRow warped;
  const float* gray;  // grey levels
  Expected expected;
  // What is found; what is not written stays unknown, and 0.
  float *residuals, *log_odds, *differences;
};

#if defined(__x86_64__)
STILLPOINT_AVX2 inline __m256 sigma_of(const DepthNoise& noise, __m256 z) {
  return _mm256_add_ps(_mm256_set1_ps(noise.floor_m),
                       _mm256_mul_ps(_mm256_mul_ps(_mm256_set1_ps(noise.per_m2), z), z));
}

/// depth_residual() of eight pixels.
STILLPOINT_AVX2 inline __m256 residuals_of_eight(__m256 measured, const Expected& expected, int x) {
  const __m256 a = sigma_of(expected.noise, _mm256_loadu_ps(expected.here + x)),
               b = sigma_of(expected.noise, measured),
               c = _mm256_mul_ps(_mm256_set1_ps(expected.off), _mm256_loadu_ps(expected.slope + x));
  const __m256 sigma = _mm256_sqrt_ps(
      _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(a, a), _mm256_mul_ps(b, b)), _mm256_mul_ps(c, c)));
  const __m256 residual = _mm256_div_ps(_mm256_sub_ps(measured, _mm256_loadu_ps(expected.depth + x)), sigma);
  return _mm256_blendv_ps(_mm256_set1_ps(kUnknown), residual,
                          _mm256_cmp_ps(measured, _mm256_setzero_ps(), _CMP_GT_OQ));
}

/// Compares eight pixels with their own pixels in the reference.
/// @returns a bit for each that is inside there and does not fit
STILLPOINT_AVX2 int compare_eight(const RgbdView& reference, float limit, int x, const ComparedRow& row) {
  const __m256i nearest = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row.warped.nearest + x));
  const __m256 inside = _mm256_castsi256_ps(_mm256_cmpgt_epi32(nearest, _mm256_set1_epi32(-1)));
  const __m256 measured = _mm256_mask_i32gather_ps(_mm256_setzero_ps(), reference.depth.ptr<float>(), nearest,
                                                   inside, sizeof(float));
  const __m256 residual = residuals_of_eight(measured, row.expected, x);
  const __m256 size = _mm256_andnot_ps(_mm256_set1_ps(-0.0F), residual);
  const __m256 fits = _mm256_and_ps(inside, _mm256_cmp_ps(size, _mm256_set1_ps(limit), _CMP_LE_OQ));
  const __m256 then = bilinear_eight(reference.gray, _mm256_loadu_ps(row.warped.u + x),
                                     _mm256_loadu_ps(row.warped.v + x), fits);
  _mm256_storeu_ps(row.residuals + x, residual);
  _mm256_storeu_ps(row.log_odds + x, _mm256_and_ps(fits, _mm256_set1_ps(kSameDepth)));
  _mm256_storeu_ps(
      row.differences + x,
      _mm256_blendv_ps(_mm256_set1_ps(kUnknown), _mm256_sub_ps(_mm256_loadu_ps(row.gray + x), then), fits));
  return _mm256_movemask_ps(_mm256_andnot_ps(fits, inside));
}
#else
int compare_eight(const RgbdView&, float, int, const ComparedRow&) { return 0; }
#endif

/// First pass: depth residuals, and plain brightness differences where the surface is the same.
cv::Mat compare_depth(const RgbdView& current, const ReferenceView& reference, const StillpointConfig& config,
                      bool wide, ReferenceEvidence& evidence) {
  constexpr int kAtOnce = 8;  // px: floats of a register
  const cv::Size size = current.depth.size();
  evidence.depth_residual = cv::Mat(size, CV_32FC1);
  evidence.log_odds = cv::Mat::zeros(size, CV_32FC1);
  cv::Mat brightness(size, CV_32FC1, cv::Scalar(kUnknown));
  DepthWarp warped(current.camera, reference.reference_from_current, wide);
  const auto limit = static_cast<float>(config.depth_sigmas);
  const cv::Mat &then = reference.view->depth, &gray_then = reference.view->gray;
  const auto* depth_then = then.ptr<float>();
  for (int y = 0; y < size.height; ++y) {
    const auto* depth = current.depth.ptr<float>(y);
    warped.warp_row(y, depth);
    const ComparedRow row{warped.row(),
                          current.gray.ptr<float>(y),
                          {warped.row().z, depth, current.depth_slope.ptr<float>(y),
                           static_cast<float>(evidence.registration_error_px), depth_noise(current)},
                          evidence.depth_residual.ptr<float>(y),
                          evidence.log_odds.ptr<float>(y),
                          brightness.ptr<float>(y)};
    const auto same_surface_at = [&](int x) {
      row.log_odds[x] = kSameDepth;
      row.differences[x] = row.gray[x] - bilinear(gray_then, warped.u(x), warped.v(x));
    };
    // Only what does not fit at its own pixel is sought beside it.
    const auto seek_beside = [&](int x) {
      const float expected = warped.z(x), beside = nearest_depth(then, warped.nearest(x), expected);
      const float residual = depth_residual(beside, row.expected, x);
      row.residuals[x] = residual;
      if (beside <= 0) return;
      if (residual > limit)
        row.log_odds[x] = kSeenThrough * std::min(1.0F, 0.5F + 0.1F * (residual - limit));
      else if (residual < -limit && expected - beside < kStepBackLimit)
        row.log_odds[x] = reference.old ? kSteppedBack : kStepsBack;
      else if (!(residual < -limit))
        same_surface_at(x);
    };
    int x = 0;
    for (; wide && x + kAtOnce <= size.width; x += kAtOnce)
      for (int misfits = compare_eight(*reference.view, limit, x, row); misfits != 0; misfits &= misfits - 1)
        seek_beside(x + std::countr_zero(static_cast<unsigned>(misfits)));
    for (; x < size.width; ++x) {
      const float measured = warped.inside(x) ? warped.at(depth_then, x) : 0.0F;
      row.residuals[x] = depth_residual(measured, row.expected, x);
      if (!warped.inside(x)) continue;
      if (std::abs(row.residuals[x]) <= limit)
        same_surface_at(x);
      else
        seek_beside(x);
    }
  }
  return brightness;
}

/// A row's brightness differences and what they are judged by, grey levels.
struct BrightnessRow {
  const float *difference, *gradient;  // NaN where there is none; of the current view
  float shift;                         // what all differ by
  float gradient_share, limit, sigma;
  bool counts;  // whether it changes log-odds
};

#if defined(__x86_64__)
/// judge_brightness() of eight pixels at a time, as far as there are eight; returns the first that is left.
STILLPOINT_AVX2 int judge_brightness_by_avx2(const BrightnessRow& row, int width, float* residuals,
                                             float* log_odds) {
  constexpr int kAtOnce = 8;  // px: floats of a register
  const __m256 zero = _mm256_setzero_ps(), limit = _mm256_set1_ps(row.limit),
               sigma = _mm256_set1_ps(row.sigma);
  int x = 0;
  for (; x + kAtOnce <= width; x += kAtOnce) {
    const __m256 difference = _mm256_loadu_ps(row.difference + x),
                 gradient = _mm256_loadu_ps(row.gradient + x);
    const __m256 known = _mm256_cmp_ps(difference, difference, _CMP_ORD_Q);
    const __m256 size =
        _mm256_andnot_ps(_mm256_set1_ps(-0.0F), _mm256_sub_ps(difference, _mm256_set1_ps(row.shift)));
    const __m256 residual =
        _mm256_max_ps(_mm256_sub_ps(size, _mm256_mul_ps(_mm256_set1_ps(row.gradient_share), gradient)), zero);
    _mm256_storeu_ps(residuals + x, _mm256_blendv_ps(_mm256_set1_ps(kUnknown), residual, known));
    if (!row.counts) continue;
    const __m256 other = _mm256_cmp_ps(residual, limit, _CMP_GT_OQ);
    const __m256 same =
        _mm256_and_ps(_mm256_cmp_ps(gradient, _mm256_mul_ps(_mm256_set1_ps(kTextured), sigma), _CMP_GT_OQ),
                      _mm256_cmp_ps(residual, sigma, _CMP_LT_OQ));
    const __m256 more = _mm256_mul_ps(_mm256_set1_ps(kOtherBrightness),
                                      _mm256_min_ps(_mm256_div_ps(residual, limit), _mm256_set1_ps(2.0F)));
    const __m256 says = _mm256_blendv_ps(_mm256_set1_ps(kSameTexture), more, other);
    const __m256 before = _mm256_loadu_ps(log_odds + x);
    _mm256_storeu_ps(log_odds + x, _mm256_blendv_ps(before, _mm256_add_ps(before, says),
                                                    _mm256_and_ps(known, _mm256_or_ps(other, same))));
  }
  return x;
}
#else
int judge_brightness_by_avx2(const BrightnessRow&, int, float*, float*) { return 0; }
#endif

/// Second pass: what a row's brightness says, once it is known how much all of it changed.
void judge_brightness(const BrightnessRow& row, int width, bool wide, float* residuals, float* log_odds) {
  for (int x = wide ? judge_brightness_by_avx2(row, width, residuals, log_odds) : 0; x < width; ++x) {
    const bool known = !std::isnan(row.difference[x]);
    const float residual =
        std::max(0.0F, std::abs(row.difference[x] - row.shift) - row.gradient_share * row.gradient[x]);
    residuals[x] = known ? residual : kUnknown;
    if (!known || !row.counts) continue;
    if (residual > row.limit)
      log_odds[x] += kOtherBrightness * std::min(2.0F, residual / row.limit);
    else if (row.gradient[x] > kTextured * row.sigma && residual < row.sigma)
      log_odds[x] += kSameTexture;
  }
}

}  // namespace

ReferenceEvidence compare_with_reference(const RgbdView& current, const ReferenceView& reference,
                                         const cv::Mat& prior, const StillpointConfig& config, bool wide) {
  ReferenceEvidence evidence;
  evidence.registration_error_px =
      static_cast<double>(registration_error(current, reference, prior, config, wide));
  const cv::Mat brightness = compare_depth(current, reference, config, wide, evidence);
  if (!config.use_depth) evidence.log_odds.setTo(0.0F);

  // Exposure may have changed between the two: the median difference is taken off; what spreads about it is
  // noise.
  std::vector<float> values;
  constexpr std::size_t kEvery = 7;  // pixels: some thousands tell a median to a few hundredths
  values.reserve(brightness.total() / kEvery + 1);
  const auto* differences = brightness.ptr<float>();
  for (std::size_t i = 0; i < brightness.total(); i += kEvery)
    if (!std::isnan(differences[i])) values.push_back(differences[i]);
  const float shift = median_of(values);
  for (float& value : values) value = std::abs(value - shift);
  const float sigma = std::max(kMinIntensitySigma, 1.4826F * median_of(values));
  evidence.intensity_sigma = sigma;

  const auto limit = static_cast<float>(config.intensity_sigmas) * sigma;
  evidence.intensity_residual = cv::Mat(brightness.size(), CV_32FC1);
  for (int y = 0; y < brightness.rows; ++y)
    judge_brightness({brightness.ptr<float>(y), current.gradient.ptr<float>(y), shift,
                      static_cast<float>(config.gradient_share), limit, sigma, config.use_brightness},
                     brightness.cols, wide, evidence.intensity_residual.ptr<float>(y),
                     evidence.log_odds.ptr<float>(y));
  return evidence;
}

namespace {

/// A row of the current view as its prior is warped.
struct PriorRow {
  DepthWarp::WarpedRow warped;
  const float *depth, *tolerance;  // m
  const float *then, *known;       // the frame before: m, and log-odds, whole images
  float keep, firm;                // share of log-odds kept, and log-odds from which all are
  float* log_odds;
  uchar* newly_observed;
};

#if defined(__x86_64__)
/// Warps the prior of eight pixels.
/// @returns a bit for each that is inside and shows another surface than the frame before
STILLPOINT_AVX2 int warp_eight(const PriorRow& row, int x) {
  const __m256 zero = _mm256_setzero_ps(), depth = _mm256_loadu_ps(row.depth + x);
  const __m256i nearest = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row.warped.nearest + x));
  const __m256 inside = _mm256_castsi256_ps(_mm256_cmpgt_epi32(nearest, _mm256_set1_epi32(-1)));
  const __m256 beside = _mm256_andnot_ps(
      _mm256_set1_ps(-0.0F), _mm256_sub_ps(_mm256_mask_i32gather_ps(zero, row.then, nearest, inside, 4),
                                           _mm256_loadu_ps(row.warped.z + x)));
  const __m256 same =
      _mm256_and_ps(inside, _mm256_cmp_ps(beside, _mm256_loadu_ps(row.tolerance + x), _CMP_LT_OQ));
  const __m256 odds = _mm256_mask_i32gather_ps(zero, row.known, nearest, same, 4);
  _mm256_storeu_ps(row.log_odds + x,
                   _mm256_blendv_ps(_mm256_mul_ps(_mm256_set1_ps(row.keep), odds), odds,
                                    _mm256_cmp_ps(odds, _mm256_set1_ps(row.firm), _CMP_GT_OQ)));
  const int is_new = _mm256_movemask_ps(_mm256_andnot_ps(inside, _mm256_cmp_ps(depth, zero, _CMP_GT_OQ)));
  for (int k = 0; is_new != 0 && k < 8; ++k) row.newly_observed[x + k] = (is_new >> k & 1) != 0 ? 255 : 0;
  return _mm256_movemask_ps(_mm256_andnot_ps(same, inside));
}
#else
int warp_eight(const PriorRow&, int) { return 0; }
#endif

}  // namespace

WarpedPrior warp_prior(const RgbdView& current, const MotionPrior& before, const Pose& previous_from_current,
                       const StillpointConfig& config, bool wide) {
  constexpr int kAtOnce = 8;            // px: floats of a register
  constexpr int kReach = 3;             // downsampled px a dynamic object may have gone in a frame
  constexpr float kLikeDepth = 0.12F;   // m, and this share of the distance
  constexpr float kDepthShare = 0.02F;  // … this one
  constexpr double kLikeSigmas = 2.0;   // … and of a stereo pair's depth, standard deviations
  constexpr float kArrived = 1.5F;      // log-odds that a dynamic object's step warps at most
  const cv::Size size = current.depth.size();
  WarpedPrior result{cv::Mat::zeros(size, CV_32FC1), cv::Mat::zeros(size, CV_8UC1)};
  cv::Mat most_near;  // the prior within reach: mostly nothing, and then nothing need be sought
  const int side = 2 * kReach + 1;
  cv::dilate(before.log_odds, most_near, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  DepthWarp warped(current.camera, previous_from_current, wide);
  const cv::Mat& depth_then = before.view->depth;
  const auto* about = most_near.ptr<float>();
  std::vector<float> tolerance(static_cast<std::size_t>(size.width));
  for (int y = 0; y < size.height; ++y) {
    const auto* depth = current.depth.ptr<float>(y);
    warped.warp_row(y, depth);
    for (std::size_t x = 0; x < tolerance.size(); ++x)
      tolerance[x] =
          kLikeDepth + kDepthShare * depth[x] +
          static_cast<float>(kLikeSigmas * current.camera.stereo_sigma(static_cast<double>(depth[x])));
    const PriorRow row{warped.row(),
                       depth,
                       tolerance.data(),
                       depth_then.ptr<float>(),
                       before.log_odds.ptr<float>(),
                       static_cast<float>(config.prior_share),
                       static_cast<float>(config.confident_log_odds),
                       result.log_odds.ptr<float>(y),
                       result.newly_observed.ptr<uchar>(y)};
    // A surface that was not here before came from beside, most likely: it is taken to move if what is
    // there does, but not confidently.
    const auto seek_beside = [&](int x) {
      if (warped.at(about, x) <= 0) return;
      const cv::Point at = warped.nearest(x);
      const float expected = warped.z(x), like = 0.5F * tolerance[static_cast<std::size_t>(x)];
      float odds = 0.0F;
      for (int py = std::max(0, at.y - kReach); py <= std::min(size.height - 1, at.y + kReach); ++py)
        for (int px = std::max(0, at.x - kReach); px <= std::min(size.width - 1, at.x + kReach); ++px) {
          const float near = before.log_odds.ptr<float>(py)[px];
          if (near > odds && std::abs(depth_then.ptr<float>(py)[px] - expected) < like) odds = near;
        }
      row.log_odds[x] = std::min(row.keep * odds, kArrived);
    };
    int x = 0;
    for (; wide && x + kAtOnce <= size.width; x += kAtOnce)
      for (int others = warp_eight(row, x); others != 0; others &= others - 1)
        seek_beside(x + std::countr_zero(static_cast<unsigned>(others)));
    for (; x < size.width; ++x) {
      if (!warped.inside(x)) {
        if (depth[x] > 0) row.newly_observed[x] = 255;
      } else if (std::abs(warped.at(row.then, x) - warped.z(x)) < tolerance[static_cast<std::size_t>(x)]) {
        const float odds = warped.at(row.known, x);
        row.log_odds[x] = odds > row.firm ? odds : row.keep * odds;
      } else {
        seek_beside(x);
      }
    }
  }
  return result;
}

}  // namespace stillpoint
