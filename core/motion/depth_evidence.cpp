#include "core/motion/depth_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/motion/carrier.hpp"

namespace stillpoint {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr float kMinIntensitySigma = 2.0F;  // grey levels: no camera is better
// Log-odds a pixel gets from one reference.
constexpr float kSeenThrough = 1.2F;  // free space where the surface is now
constexpr float kStepsBack = 0.5F;    // a surface nearer by little: most likely the same one, moving off
constexpr float kSteppedBack = 0.1F;  // … less likely the same one, the longer ago
constexpr float kOtherBrightness = 0.6F;
constexpr float kSameDepth = -0.25F;     // weak: the middle of a mover agrees with itself
constexpr float kSameTexture = -0.4F;    // a textured pixel that looks the same does stand still
constexpr float kStepBackLimit = 0.15F;  // m: a surface farther off than this was another one

/// Of the nine measurements about a pixel, the one nearest to what is expected; 0 when there is none. Edges
/// lie a pixel off easily, and then the neighbour still has the surface.
float nearest_depth(const cv::Mat& depth, int x, int y, float expected) {
  float best = 0.0F, best_difference = std::numeric_limits<float>::max();
  for (int dy = -1; dy <= 1; ++dy) {
    const float* row = depth.ptr<float>(y + dy) + x;
    for (int dx = -1; dx <= 1; ++dx) {
      const float difference = std::abs(row[dx] - expected);
      if (row[dx] > 0 && difference < best_difference) best = row[dx], best_difference = difference;
    }
  }
  return best;
}

float median_of(std::vector<float>& values) {
  if (values.empty()) return 0.0F;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// First pass: depth residuals, and plain brightness differences where the surface is the same.
cv::Mat compare_depth(const RgbdView& current, const ReferenceView& reference,
                      const DepthMotionConfig& config, ReferenceEvidence& evidence) {
  const cv::Size size = current.depth.size();
  evidence.depth_residual = cv::Mat(size, CV_32FC1, cv::Scalar(kUnknown));
  evidence.log_odds = cv::Mat::zeros(size, CV_32FC1);
  cv::Mat brightness(size, CV_32FC1, cv::Scalar(kUnknown));
  const Carrier carry(current.camera, reference.reference_from_current);
  const auto limit = static_cast<float>(config.depth_sigmas);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const float z = current.depth.at<float>(y, x);
      if (z <= 0) continue;
      const Carried there = carry(x, y, z);
      if (!there.inside) continue;
      const float measured =
          nearest_depth(reference.view->depth, cvRound(there.u), cvRound(there.v), there.z);
      if (measured <= 0) continue;
      const float sigma = std::hypot(depth_sigma(z), depth_sigma(measured));
      const float residual = (measured - there.z) / sigma;
      evidence.depth_residual.at<float>(y, x) = residual;
      float& odds = evidence.log_odds.at<float>(y, x);
      if (residual > limit) {
        odds = kSeenThrough * std::min(1.0F, 0.5F + 0.1F * (residual - limit));
      } else if (residual < -limit) {
        if (there.z - measured < kStepBackLimit) odds = reference.old ? kSteppedBack : kStepsBack;
      } else {
        odds = kSameDepth;
        brightness.at<float>(y, x) =
            current.gray.at<float>(y, x) - bilinear(reference.view->gray, there.u, there.v);
      }
    }
  return brightness;
}

}  // namespace

float depth_sigma(float z) { return 0.0012F + 0.0019F * z * z; }

ReferenceEvidence compare_with_reference(const RgbdView& current, const ReferenceView& reference,
                                         const DepthMotionConfig& config) {
  ReferenceEvidence evidence;
  const cv::Mat brightness = compare_depth(current, reference, config, evidence);
  if (config.use_depth == 0) evidence.log_odds.setTo(0.0F);

  // Exposure may have changed between the two: the median difference is taken off; what spreads about it is
  // noise.
  std::vector<float> values;
  for (int i = 0; i < static_cast<int>(brightness.total()); i += 3)
    if (const float b = brightness.at<float>(i / brightness.cols, i % brightness.cols); !std::isnan(b))
      values.push_back(b);
  const float shift = median_of(values);
  for (float& value : values) value = std::abs(value - shift);
  const float sigma = std::max(kMinIntensitySigma, 1.4826F * median_of(values));
  evidence.intensity_sigma = sigma;

  const auto limit = static_cast<float>(config.intensity_sigmas) * sigma;
  const auto share = static_cast<float>(config.gradient_share);
  evidence.intensity_residual = cv::Mat(brightness.size(), CV_32FC1, cv::Scalar(kUnknown));
  for (int y = 0; y < brightness.rows; ++y)
    for (int x = 0; x < brightness.cols; ++x) {
      const float b = brightness.at<float>(y, x);
      if (std::isnan(b)) continue;
      const float gradient = current.gradient.at<float>(y, x);
      const float residual = std::max(0.0F, std::abs(b - shift) - share * gradient);
      evidence.intensity_residual.at<float>(y, x) = residual;
      if (config.use_brightness == 0) continue;
      float& odds = evidence.log_odds.at<float>(y, x);
      if (residual > limit)
        odds += kOtherBrightness * std::min(2.0F, residual / limit);
      else if (gradient > 3.0F * sigma && residual < sigma)
        odds += kSameTexture;
    }
  return evidence;
}

cv::Mat carry_memory(const RgbdView& current, const MotionMemory& memory, const Pose& previous_from_current,
                     const DepthMotionConfig& config) {
  constexpr int kReach = 3;            // small px a mover may have gone in a frame
  constexpr float kLikeDepth = 0.12F;  // m, and this share of the distance
  constexpr float kDepthShare = 0.02F;
  constexpr float kArrived = 1.5F;  // log-odds that a mover's step carries at most
  cv::Mat prior = cv::Mat::zeros(current.depth.size(), CV_32FC1);
  const Carrier carry(current.camera, previous_from_current);
  const auto keep = static_cast<float>(config.memory), firm = static_cast<float>(config.firm_log_odds);
  for (int y = 0; y < prior.rows; ++y)
    for (int x = 0; x < prior.cols; ++x) {
      const float z = current.depth.at<float>(y, x);
      if (z <= 0) continue;
      const Carried there = carry(x, y, z);
      if (!there.inside) continue;
      const int u = cvRound(there.u), v = cvRound(there.v);
      const float tolerance = kLikeDepth + kDepthShare * z;
      if (std::abs(memory.view->depth.at<float>(v, u) - there.z) < tolerance) {
        const float odds = memory.log_odds.at<float>(v, u);
        prior.at<float>(y, x) = odds > firm ? odds : keep * odds;
        continue;
      }
      // A surface that was not here before came from beside, most likely: it is taken to move if what is
      // there does, but not firmly.
      float odds = 0.0F;
      for (int dy = -kReach; dy <= kReach; ++dy)
        for (int dx = -kReach; dx <= kReach; ++dx) {
          const int px = u + dx, py = v + dy;
          if (px < 0 || py < 0 || px >= prior.cols || py >= prior.rows) continue;
          const float near = memory.log_odds.at<float>(py, px);
          if (near > odds && std::abs(memory.view->depth.at<float>(py, px) - there.z) < 0.5F * tolerance)
            odds = near;
        }
      prior.at<float>(y, x) = std::min(keep * odds, kArrived);
    }
  return prior;
}

}  // namespace stillpoint
