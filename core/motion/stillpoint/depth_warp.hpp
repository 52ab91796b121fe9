#pragma once

#include <algorithm>
#include <array>
#include <opencv2/core.hpp>
#include <opencv2/core/hal/intrin.hpp>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"

namespace stillpoint {

/// Warps pixels of the current view into another one by a rotation and translation, a row at a time, in
/// single precision and several pixels at once: the whole image passes here, many times a frame.
class DepthWarp {
 public:
  DepthWarp(const Camera& camera, const Pose& other_from_current)
      : width_(camera.width),
        right_(static_cast<float>(camera.width - 2)),
        bottom_(static_cast<float>(camera.height - 2)),
        fx_(static_cast<float>(camera.fx)),
        fy_(static_cast<float>(camera.fy)),
        cx_(static_cast<float>(camera.cx)),
        cy_(static_cast<float>(camera.cy)),
        sideways_(static_cast<std::size_t>((camera.width + kLanes - 1) / kLanes * kLanes)),
        u_(sideways_.size()),
        v_(sideways_.size()),
        z_(sideways_.size()),
        nearest_(sideways_.size()) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c)
        r_[static_cast<std::size_t>(3 * r + c)] = static_cast<float>(other_from_current.linear()(r, c));
      t_[static_cast<std::size_t>(r)] = static_cast<float>(other_from_current.translation()(r));
    }
    for (std::size_t x = 0; x < sideways_.size(); ++x) sideways_[x] = (static_cast<float>(x) - cx_) / fx_;
  }

  /// @param depth of row y, m; 0 where there is none
  void warp_row(int y, const float* depth) {
    const float down = (static_cast<float>(y) - cy_) / fy_;
    const Row row{r_[1] * down + r_[2], r_[4] * down + r_[5], r_[7] * down + r_[8]};
    int x = 0;
    for (; x + kLanes <= width_; x += kLanes) warp(static_cast<std::size_t>(x), cv::v_load(depth + x), row);
    if (x == width_) return;
    std::array<float, kLanes> rest{};
    std::copy(depth + x, depth + width_, rest.begin());
    warp(static_cast<std::size_t>(x), cv::v_load(rest.data()), row);
  }

  /// Of the row warped last: whether pixel x has depth and lies in the other view, a pixel from its rim.
  [[nodiscard]] bool inside(int x) const { return nearest_[static_cast<std::size_t>(x)] >= 0; }
  /// Where it lies, px, and how far away it is expected there, m; if it is inside.
  [[nodiscard]] float u(int x) const { return u_[static_cast<std::size_t>(x)]; }
  [[nodiscard]] float v(int x) const { return v_[static_cast<std::size_t>(x)]; }
  [[nodiscard]] float z(int x) const { return z_[static_cast<std::size_t>(x)]; }
  /// The pixel nearest to there; if it is inside.
  [[nodiscard]] cv::Point nearest(int x) const {
    const int at = nearest_[static_cast<std::size_t>(x)];
    return {at % width_, at / width_};
  }
  /// The value the other view's image has there, of the current one's size and in one piece; if it is inside.
  template <typename T>
  [[nodiscard]] const T& at(const T* image, int x) const {
    return image[nearest_[static_cast<std::size_t>(x)]];
  }
  /// z() of the whole row; of a pixel without depth it means nothing.
  [[nodiscard]] const float* expected_depth() const { return z_.data(); }

 private:
  static constexpr int kLanes = cv::v_float32x4::nlanes;
  static constexpr float kNearest = 0.1F;  // m: nearer, nothing is measured, and pixels run off to infinity

  /// What the pixels of a row share: rotation's part of where they lie, by row.
  struct Row {
    float x, y, z;
  };

  void warp(std::size_t x, const cv::v_float32x4& z, const Row& row) {
    const auto all = [](float value) { return cv::v_setall_f32(value); };
    const cv::v_float32x4 sideways = cv::v_load(&sideways_[x]);
    const cv::v_float32x4 there = (all(r_[6]) * sideways + all(row.z)) * z + all(t_[2]);
    const cv::v_float32x4 u =
        all(fx_) * ((all(r_[0]) * sideways + all(row.x)) * z + all(t_[0])) / there + all(cx_);
    const cv::v_float32x4 v =
        all(fy_) * ((all(r_[3]) * sideways + all(row.y)) * z + all(t_[1])) / there + all(cy_);
    const cv::v_float32x4 inside = (z > cv::v_setzero_f32()) & (there >= all(kNearest)) & (u >= all(1.0F)) &
                                   (v >= all(1.0F)) & (u < all(right_)) & (v < all(bottom_));
    const cv::v_int32x4 nearest =
        cv::v_round(inside & v) * cv::v_setall_s32(width_) + cv::v_round(inside & u);
    cv::v_store(&u_[x], u);
    cv::v_store(&v_[x], v);
    cv::v_store(&z_[x], there);
    cv::v_store(&nearest_[x], cv::v_select(cv::v_reinterpret_as_s32(inside), nearest, cv::v_setall_s32(-1)));
  }

  int width_;
  float right_, bottom_;  // px: what lies beyond has not all its neighbours
  float fx_, fy_, cx_, cy_;
  std::array<float, 9> r_{};
  std::array<float, 3> t_{};
  std::vector<float> sideways_;   // of each column's ray
  std::vector<float> u_, v_, z_;  // of the row warped last …
  std::vector<int> nearest_;  // … and each pixel's nearest there, counted along the rows; -1 = not inside
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
