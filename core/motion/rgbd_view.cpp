#include "core/motion/rgbd_view.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>

namespace stillpoint {
namespace {

/// The first measurement of a block that has none in its middle.
float any_depth(const cv::Mat& depth, int x0, int y0, int factor) {
  for (int y = y0; y < y0 + factor; ++y)
    for (int x = x0; x < x0 + factor; ++x)
      if (const float z = depth.at<float>(y, x); z > 0) return z;
  return 0.0F;
}

cv::Mat steepest_neighbour(const cv::Mat& gray) {
  cv::Mat low, high, range;
  const cv::Mat cross = cv::getStructuringElement(cv::MORPH_CROSS, {3, 3});
  cv::erode(gray, low, cross);
  cv::dilate(gray, high, cross);
  high -= gray;
  low = gray - low;
  cv::max(high, low, range);
  return range;
}

/// A quarter of the difference of both neighbours: two images' slopes are averaged by adding theirs.
void slopes(const cv::Mat& gray, cv::Mat& slope_x, cv::Mat& slope_y) {
  slope_x = cv::Mat::zeros(gray.size(), CV_32FC1);
  slope_y = cv::Mat::zeros(gray.size(), CV_32FC1);
  for (int y = 1; y + 1 < gray.rows; ++y) {
    const auto *above = gray.ptr<float>(y - 1), *row = gray.ptr<float>(y), *below = gray.ptr<float>(y + 1);
    auto *sideways = slope_x.ptr<float>(y), *down = slope_y.ptr<float>(y);
    for (int x = 1; x + 1 < gray.cols; ++x) {
      sideways[x] = 0.25F * (row[x + 1] - row[x - 1]);
      down[x] = 0.25F * (below[x] - above[x]);
    }
  }
}

constexpr int kLanes = cv::v_float32x4::nlanes;

/// same_surface() of four pixels at once.
cv::v_float32x4 same_surface(const cv::v_float32x4& a, const cv::v_float32x4& b) {
  const cv::v_float32x4 nearer = cv::v_min(a, b);
  return cv::v_abs(a - b) < cv::v_setall_f32(0.02F) + cv::v_setall_f32(0.012F) * nearer * nearer;
}

/// Which pixels lie within their surface, and how steep it is there.
void describe_surface(const cv::Mat& depth, cv::Mat& within, cv::Mat& slope) {
  within = cv::Mat::zeros(depth.size(), CV_8UC1);
  slope = cv::Mat::zeros(depth.size(), CV_32FC1);
  for (int y = 1; y + 1 < depth.rows; ++y) {
    const auto *above = depth.ptr<float>(y - 1), *row = depth.ptr<float>(y), *below = depth.ptr<float>(y + 1);
    auto* inner = within.ptr<uchar>(y);
    auto* steepest = slope.ptr<float>(y);
    int x = 1;
    for (; x + kLanes < depth.cols; x += kLanes) {
      const cv::v_float32x4 z = cv::v_load(row + x), zero = cv::v_setzero_f32();
      cv::v_float32x4 all = z > zero, step = zero;
      for (const float* beside : {row + x - 1, row + x + 1, above + x, below + x}) {
        const cv::v_float32x4 other = cv::v_load(beside), same = (other > zero) & same_surface(z, other);
        all = all & same;
        step = cv::v_max(step, same & cv::v_abs(other - z));
      }
      const int within_all = cv::v_signmask(all);
      for (int k = 0; k < kLanes; ++k) inner[x + k] = (within_all >> k & 1) != 0 ? 255 : 0;
      cv::v_store(steepest + x, (z > zero) & step);
    }
    for (; x + 1 < depth.cols; ++x) {
      const float z = row[x];
      if (z <= 0) continue;
      bool all = true;
      float step = 0.0F;
      for (const float other : {row[x - 1], row[x + 1], above[x], below[x]}) {
        const bool same = (other > 0) & stillpoint::same_surface(z, other);
        all &= same;
        step = std::max(step, same ? std::abs(other - z) : 0.0F);
      }
      inner[x] = all ? 255 : 0;
      steepest[x] = step;
    }
  }
}

}  // namespace

RgbdView make_rgbd_view(const cv::Mat& gray, const cv::Mat& depth, const Camera& camera, int factor) {
  RgbdView view;
  view.factor = factor;
  const cv::Size size(gray.cols / factor, gray.rows / factor);
  cv::Mat small;
  cv::resize(gray(cv::Rect(0, 0, size.width * factor, size.height * factor)), small, size, 0, 0,
             cv::INTER_AREA);
  small.convertTo(view.gray, CV_32F);
  view.gradient = steepest_neighbour(view.gray);
  view.depth = cv::Mat::zeros(size, CV_32FC1);
  const int middle = factor / 2;
  for (int y = 0; y < size.height && !depth.empty(); ++y) {
    const auto* row = depth.ptr<float>(y * factor + middle);
    auto* out = view.depth.ptr<float>(y);
    for (int x = 0; x < size.width; ++x) {
      const float centre = row[x * factor + middle];
      out[x] = centre > 0 ? centre : any_depth(depth, x * factor, y * factor, factor);
    }
  }
  slopes(view.gray, view.slope_x, view.slope_y);
  describe_surface(view.depth, view.within_surface, view.depth_slope);
  view.camera = camera.scaled_to(gray.cols, gray.rows);
  view.camera.fx /= factor, view.camera.fy /= factor;
  view.camera.cx = (view.camera.cx + 0.5) / factor - 0.5,
  view.camera.cy = (view.camera.cy + 0.5) / factor - 0.5;
  view.camera.width = size.width, view.camera.height = size.height;
  return view;
}

}  // namespace stillpoint
