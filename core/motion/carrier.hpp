#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"

namespace stillpoint {

/// Carries pixels of the current view into another one by a rotation and translation, a row at a time and in
/// single precision: the whole image passes here, and a row without branches is worked on several pixels at
/// once.
class Carrier {
 public:
  Carrier(const Camera& camera, const Pose& other_from_current)
      : right_(static_cast<float>(camera.width - 2)),
        bottom_(static_cast<float>(camera.height - 2)),
        fx_(static_cast<float>(camera.fx)),
        fy_(static_cast<float>(camera.fy)),
        cx_(static_cast<float>(camera.cx)),
        cy_(static_cast<float>(camera.cy)),
        slope_(static_cast<std::size_t>(camera.width)),
        u_(slope_.size()),
        v_(slope_.size()),
        z_(slope_.size()) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c)
        r_[static_cast<std::size_t>(3 * r + c)] = static_cast<float>(other_from_current.linear()(r, c));
      t_[static_cast<std::size_t>(r)] = static_cast<float>(other_from_current.translation()(r));
    }
    for (std::size_t x = 0; x < slope_.size(); ++x) slope_[x] = (static_cast<float>(x) - cx_) / fx_;
  }

  /// @param depth of row y, m; 0 where there is none
  void carry_row(int y, const float* depth) {
    const float down = (static_cast<float>(y) - cy_) / fy_;
    const float a = r_[1] * down + r_[2], b = r_[4] * down + r_[5], c = r_[7] * down + r_[8];
    for (std::size_t x = 0; x < slope_.size(); ++x) {
      const float z = depth[x], sideways = slope_[x];
      const float there = (r_[6] * sideways + c) * z + t_[2];
      const float u = fx_ * ((r_[0] * sideways + a) * z + t_[0]) / there + cx_;
      const float v = fy_ * ((r_[3] * sideways + b) * z + t_[1]) / there + cy_;
      const bool inside =
          (z > 0.0F) & (there >= kNearest) & (u >= 1.0F) & (v >= 1.0F) & (u < right_) & (v < bottom_);
      u_[x] = inside ? u : -1.0F;
      v_[x] = v;
      z_[x] = there;
    }
  }

  /// Of the row carried last: whether pixel x has depth and lies in the other view, a pixel from its rim.
  [[nodiscard]] bool inside(int x) const { return u_[static_cast<std::size_t>(x)] >= 0.0F; }
  /// Where it lies, px, and how far away it is expected there, m; if it is inside.
  [[nodiscard]] float u(int x) const { return u_[static_cast<std::size_t>(x)]; }
  [[nodiscard]] float v(int x) const { return v_[static_cast<std::size_t>(x)]; }
  [[nodiscard]] float z(int x) const { return z_[static_cast<std::size_t>(x)]; }
  /// z() of the whole row; of a pixel without depth it means nothing.
  [[nodiscard]] const float* expected_depth() const { return z_.data(); }

 private:
  static constexpr float kNearest = 0.1F;  // m

  float right_, bottom_;  // px: what lies beyond has not all its neighbours
  float fx_, fy_, cx_, cy_;
  std::array<float, 9> r_{};
  std::array<float, 3> t_{};
  std::vector<float> slope_;      // of each column's ray, sideways
  std::vector<float> u_, v_, z_;  // of the row carried last
};

/// A CV_32FC1 image between its pixels; u and v at least 0 and below the last column and row.
[[nodiscard]] inline float bilinear(const cv::Mat& image, float u, float v) {
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const float a = u - static_cast<float>(x), b = v - static_cast<float>(y);
  const float* top = image.ptr<float>(y) + x;
  const float* bottom = image.ptr<float>(y + 1) + x;
  return (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]);
}

}  // namespace stillpoint
