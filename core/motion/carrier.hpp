#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"

namespace stillpoint {

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

/// A CV_32FC1 image between its pixels; u and v at least 0 and below the last column and row.
[[nodiscard]] inline float bilinear(const cv::Mat& image, float u, float v) {
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const float a = u - static_cast<float>(x), b = v - static_cast<float>(y);
  const float* top = image.ptr<float>(y) + x;
  const float* bottom = image.ptr<float>(y + 1) + x;
  return (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]);
}

}  // namespace stillpoint
