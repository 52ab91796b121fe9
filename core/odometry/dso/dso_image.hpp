#pragma once

#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/odometry/masked_engine.hpp"

namespace stillpoint {

/// A frame's brightness and its slopes at several sizes, each half the last.
struct DsoImage final : TrackerPreparation {
  std::vector<cv::Mat> levels;  ///< CV_32FC3: grey level, slope sideways, slope down (grey levels a pixel)
  std::vector<Camera> cameras;  ///< one a level, without distortion
};

/// @param gray CV_8UC1, rectified; @param camera of that image
[[nodiscard]] std::shared_ptr<const DsoImage> make_dso_image(const cv::Mat& gray, const Camera& camera,
                                                             int levels);

/// The eight pixels of a point, px from its middle: DSO's pattern.
inline constexpr std::array<std::array<int, 2>, 8> kDsoPattern = {
    {{0, -2}, {-1, -1}, {1, -1}, {-2, 0}, {0, 0}, {2, 0}, {-1, 1}, {0, 2}}};
inline constexpr int kDsoReach = 3;  ///< px that a point keeps off the image's edges

/// Grey level and slopes between pixels; the place lies inside by a pixel.
[[nodiscard]] inline cv::Vec3f sample(const cv::Mat& image, double x, double y) {
  const int u = static_cast<int>(x), v = static_cast<int>(y);
  const auto a = static_cast<float>(x - u), b = static_cast<float>(y - v);
  const auto* top = image.ptr<cv::Vec3f>(v) + u;
  const auto* bottom = image.ptr<cv::Vec3f>(v + 1) + u;
  cv::Vec3f value;
  for (int i = 0; i < 3; ++i)
    value[i] =
        (1 - b) * ((1 - a) * top[0][i] + a * top[1][i]) + b * ((1 - a) * bottom[0][i] + a * bottom[1][i]);
  return value;
}

[[nodiscard]] inline bool inside(const cv::Mat& image, double x, double y, double margin) {
  return x >= margin && y >= margin && x < image.cols - 1 - margin && y < image.rows - 1 - margin;
}

/// Brightness as a frame shows it: log gain a and offset b. Between frames i and j a point's pixel goes from
/// I_i to e^(a_j - a_i) (I_i - b_i) + b_j.
struct Affine {
  double a = 0.0, b = 0.0;
};

/// r = (I_j - b_j) - e^(a_j - a_i) (I_i - b_i), grey levels.
[[nodiscard]] inline double photometric_residual(double shown, const Affine& in, double was,
                                                 const Affine& of) {
  return (shown - in.b) - std::exp(in.a - of.a) * (was - of.b);
}

/// c² / (c² + |slope|²): steep pixels weigh less, as a small misplacement changes them much.
[[nodiscard]] inline double gradient_weight(double slope_x, double slope_y, double softness) {
  const double c = softness * softness;
  return c / (c + slope_x * slope_x + slope_y * slope_y);
}

/// Huber's weight of a residual.
[[nodiscard]] inline double huber_weight(double residual, double bound) {
  const double size = std::abs(residual);
  return size <= bound ? 1.0 : bound / size;
}

}  // namespace stillpoint
