#pragma once

#include <algorithm>
#include <array>
#include <opencv2/core.hpp>
#include <opencv2/core/hal/intrin.hpp>
#include <vector>

#include "core/avx2.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/wide_lanes.hpp"

namespace stillpoint {

/// A CV_32FC1 image between its pixels; u and v at least 0 and below the last column and row.
[[nodiscard]] inline float bilinear(const cv::Mat& image, float u, float v) {
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const float a = u - static_cast<float>(x), b = v - static_cast<float>(y);
  const float* top = image.ptr<float>(y) + x;
  const float* bottom = image.ptr<float>(y + 1) + x;
  return (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]);
}

#if defined(__x86_64__)
/// bilinear() of eight places, those that `where` has; 0 of the others. The image must be in one piece.
[[nodiscard]] STILLPOINT_AVX2 inline __m256 bilinear_eight(const cv::Mat& image, __m256 u, __m256 v,
                                                           __m256 where) {
  const __m256i x = _mm256_cvttps_epi32(u), y = _mm256_cvttps_epi32(v);
  const __m256 one = _mm256_set1_ps(1.0F), a = _mm256_sub_ps(u, _mm256_cvtepi32_ps(x)),
               b = _mm256_sub_ps(v, _mm256_cvtepi32_ps(y)), before = _mm256_sub_ps(one, a),
               above = _mm256_sub_ps(one, b);
  const __m256i at = _mm256_add_epi32(_mm256_mullo_epi32(y, _mm256_set1_epi32(image.cols)), x);
  const auto* top = image.ptr<float>();
  const float* bottom = top + image.cols;
  const __m256 none = _mm256_setzero_ps();
  const __m256 upper = _mm256_add_ps(_mm256_mul_ps(before, _mm256_mask_i32gather_ps(none, top, at, where, 4)),
                                     _mm256_mul_ps(a, _mm256_mask_i32gather_ps(none, top + 1, at, where, 4)));
  const __m256 lower =
      _mm256_add_ps(_mm256_mul_ps(before, _mm256_mask_i32gather_ps(none, bottom, at, where, 4)),
                    _mm256_mul_ps(a, _mm256_mask_i32gather_ps(none, bottom + 1, at, where, 4)));
  return _mm256_and_ps(_mm256_add_ps(_mm256_mul_ps(above, upper), _mm256_mul_ps(b, lower)), where);
}
#endif

/// Warps pixels of the current view into another one by a rotation and translation, a row at a time, in
/// single precision and several pixels at once: the whole image passes here, many times a frame.
class DepthWarp {
 public:
  /// @param wide eight pixels at once, for processors that have such lanes; where they lie is the same
  DepthWarp(const Camera& camera, const Pose& other_from_current, bool wide = has_wide_lanes())
      : wide_(wide),
        width_(camera.width),
        right_(static_cast<float>(camera.width - 2)),
        bottom_(static_cast<float>(camera.height - 2)),
        fx_(static_cast<float>(camera.fx)),
        fy_(static_cast<float>(camera.fy)),
        cx_(static_cast<float>(camera.cx)),
        cy_(static_cast<float>(camera.cy)),
        sideways_(static_cast<std::size_t>((camera.width + kWideLanes - 1) / kWideLanes * kWideLanes)),
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
    int x = wide_ ? warp_by_avx2(depth, row) : 0;
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
  /// u(), v() and z() of the whole row, which mean nothing of pixels without depth; and their nearest pixels,
  /// counted along the other view's rows, below 0 where they are not inside.
  struct WarpedRow {
    const float *u, *v, *z;
    const int* nearest;
  };
  [[nodiscard]] WarpedRow row() const { return {u_.data(), v_.data(), z_.data(), nearest_.data()}; }

  /// bilinear() of an image of the other view, in one piece, at every pixel of the row that is inside.
  void sample_row(const cv::Mat& image, std::vector<float>& values) const {
    values.resize(u_.size());
    int x = wide_ ? sample_by_avx2(image, values.data()) : 0;
    for (; x < width_; ++x)
      if (inside(x)) values[static_cast<std::size_t>(x)] = bilinear(image, u(x), v(x));
  }

 private:
  static constexpr int kLanes = cv::v_float32x4::nlanes, kWideLanes = 8;  // floats of a register
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

#if defined(__x86_64__)
  /// One coordinate in the other camera, m. @param by what the ray's sideways part adds to it
  STILLPOINT_AVX2 static inline __m256 turned(__m256 sideways, float by, float of_row, __m256 z,
                                              float moved) {
    const __m256 ray = _mm256_add_ps(_mm256_mul_ps(_mm256_set1_ps(by), sideways), _mm256_set1_ps(of_row));
    return _mm256_add_ps(_mm256_mul_ps(ray, z), _mm256_set1_ps(moved));
  }
  STILLPOINT_AVX2 static inline __m256 projected(float focal, __m256 at, __m256 there, float centre) {
    return _mm256_add_ps(_mm256_div_ps(_mm256_mul_ps(_mm256_set1_ps(focal), at), there),
                         _mm256_set1_ps(centre));
  }

  /// warp() of eight pixels at a time, as far as there are eight; returns the first that is left.
  STILLPOINT_AVX2 int warp_by_avx2(const float* depth, const Row& row) {
    const __m256 first = _mm256_set1_ps(1.0F);
    int x = 0;
    for (; x + kWideLanes <= width_; x += kWideLanes) {
      const __m256 sideways = _mm256_loadu_ps(&sideways_[static_cast<std::size_t>(x)]),
                   z = _mm256_loadu_ps(depth + x), there = turned(sideways, r_[6], row.z, z, t_[2]);
      const __m256 u = projected(fx_, turned(sideways, r_[0], row.x, z, t_[0]), there, cx_),
                   v = projected(fy_, turned(sideways, r_[3], row.y, z, t_[1]), there, cy_);
      __m256 inside = _mm256_and_ps(_mm256_cmp_ps(z, _mm256_setzero_ps(), _CMP_GT_OQ),
                                    _mm256_cmp_ps(there, _mm256_set1_ps(kNearest), _CMP_GE_OQ));
      inside = _mm256_and_ps(
          inside, _mm256_and_ps(_mm256_cmp_ps(u, first, _CMP_GE_OQ), _mm256_cmp_ps(v, first, _CMP_GE_OQ)));
      inside = _mm256_and_ps(inside, _mm256_and_ps(_mm256_cmp_ps(u, _mm256_set1_ps(right_), _CMP_LT_OQ),
                                                   _mm256_cmp_ps(v, _mm256_set1_ps(bottom_), _CMP_LT_OQ)));
      const __m256i nearest = _mm256_add_epi32(
          _mm256_mullo_epi32(_mm256_cvtps_epi32(_mm256_and_ps(inside, v)), _mm256_set1_epi32(width_)),
          _mm256_cvtps_epi32(_mm256_and_ps(inside, u)));
      const auto at = static_cast<std::size_t>(x);
      _mm256_storeu_ps(&u_[at], u);
      _mm256_storeu_ps(&v_[at], v);
      _mm256_storeu_ps(&z_[at], there);
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(&nearest_[at]),
                          _mm256_blendv_epi8(_mm256_set1_epi32(-1), nearest, _mm256_castps_si256(inside)));
    }
    return x;
  }

  STILLPOINT_AVX2 int sample_by_avx2(const cv::Mat& image, float* values) const {
    int x = 0;
    for (; x + kWideLanes <= width_; x += kWideLanes) {
      const auto at = static_cast<std::size_t>(x);
      const __m256i nearest = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(&nearest_[at]));
      const __m256 inside = _mm256_castsi256_ps(_mm256_cmpgt_epi32(nearest, _mm256_set1_epi32(-1)));
      _mm256_storeu_ps(values + x,
                       bilinear_eight(image, _mm256_loadu_ps(&u_[at]), _mm256_loadu_ps(&v_[at]), inside));
    }
    return x;
  }
#else
  int warp_by_avx2(const float*, const Row&) { return 0; }
  int sample_by_avx2(const cv::Mat&, float*) const { return 0; }
#endif

  bool wide_;
  int width_;
  float right_, bottom_;  // px: what lies beyond has not all its neighbours
  float fx_, fy_, cx_, cy_;
  std::array<float, 9> r_{};
  std::array<float, 3> t_{};
  std::vector<float> sideways_;   // of each column's ray
  std::vector<float> u_, v_, z_;  // of the row warped last …
  std::vector<int> nearest_;  // … and each pixel's nearest there, counted along the rows; -1 = not inside
};

}  // namespace stillpoint
