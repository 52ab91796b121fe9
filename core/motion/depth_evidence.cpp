#include "core/motion/depth_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace stillpoint {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr float kMinIntensitySigma = 2.0F;  // grey levels: no camera is better
// Log-odds a pixel gets from one reference.
constexpr float kSeenThrough = 1.2F;  // free space where the surface is now
constexpr float kStepsBack = 0.5F;    // a surface nearer by little: most likely the same one, moving off
constexpr float kOtherBrightness = 0.6F;
constexpr float kSameDepth = -0.25F;     // weak: the middle of a mover agrees with itself
constexpr float kSameTexture = -0.4F;    // a textured pixel that looks the same does stand still
constexpr float kStepBackLimit = 0.15F;  // m: a surface farther off than this was another one

/// Where a pixel of the current view lies in the reference.
struct Carried {
  bool inside = false;
  float u = 0, v = 0;  // px
  float z = 0;         // m, expected there
};

/// Carries pixels by a rotation and translation in single precision: the whole image passes here.
class Carrier {
 public:
  Carrier(const Camera& camera, const Pose& other_from_current) : camera_(camera) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c)
        r_[static_cast<std::size_t>(3 * r + c)] = static_cast<float>(other_from_current.linear()(r, c));
      t_[static_cast<std::size_t>(r)] = static_cast<float>(other_from_current.translation()(r));
    }
    fx_ = static_cast<float>(camera.fx), fy_ = static_cast<float>(camera.fy);
    cx_ = static_cast<float>(camera.cx), cy_ = static_cast<float>(camera.cy);
  }

  [[nodiscard]] Carried operator()(int x, int y, float z) const {
    const float px = (static_cast<float>(x) - cx_) / fx_ * z, py = (static_cast<float>(y) - cy_) / fy_ * z;
    Carried c;
    c.z = r_[6] * px + r_[7] * py + r_[8] * z + t_[2];
    if (c.z < 0.1F) return c;
    c.u = fx_ * (r_[0] * px + r_[1] * py + r_[2] * z + t_[0]) / c.z + cx_;
    c.v = fy_ * (r_[3] * px + r_[4] * py + r_[5] * z + t_[1]) / c.z + cy_;
    c.inside = c.u >= 1 && c.v >= 1 && c.u < static_cast<float>(camera_.width - 2) &&
               c.v < static_cast<float>(camera_.height - 2);
    return c;
  }

 private:
  const Camera& camera_;
  std::array<float, 9> r_{};
  std::array<float, 3> t_{};
  float fx_, fy_, cx_, cy_;
};

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

float bilinear(const cv::Mat& image, float u, float v) {
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const float a = u - static_cast<float>(x), b = v - static_cast<float>(y);
  const float* top = image.ptr<float>(y) + x;
  const float* bottom = image.ptr<float>(y + 1) + x;
  return (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]);
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
        if (there.z - measured < kStepBackLimit) odds = kStepsBack;
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
  cv::Mat prior = cv::Mat::zeros(current.depth.size(), CV_32FC1);
  const Carrier carry(current.camera, previous_from_current);
  const auto keep = static_cast<float>(config.memory);
  for (int y = 0; y < prior.rows; ++y)
    for (int x = 0; x < prior.cols; ++x) {
      const float z = current.depth.at<float>(y, x);
      if (z <= 0) continue;
      const Carried there = carry(x, y, z);
      if (!there.inside) continue;
      const int u = cvRound(there.u), v = cvRound(there.v);
      const float tolerance = kLikeDepth + kDepthShare * z;
      float odds = 0.0F;
      if (std::abs(memory.view->depth.at<float>(v, u) - there.z) < tolerance)
        odds = memory.log_odds.at<float>(v, u);
      // What moved may come from beside; it is remembered as moving wherever it steps, if nothing surer is
      // known.
      if (odds <= 0)
        for (int dy = -kReach; dy <= kReach; ++dy)
          for (int dx = -kReach; dx <= kReach; ++dx) {
            const int px = u + dx, py = v + dy;
            if (px < 0 || py < 0 || px >= prior.cols || py >= prior.rows) continue;
            const float near = memory.log_odds.at<float>(py, px);
            if (near > odds && near > 0 &&
                std::abs(memory.view->depth.at<float>(py, px) - there.z) < 0.5F * tolerance)
              odds = near;
          }
      prior.at<float>(y, x) = keep * odds;
    }
  return prior;
}

}  // namespace stillpoint
