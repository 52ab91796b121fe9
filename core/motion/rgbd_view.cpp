#include "core/motion/rgbd_view.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/avx2.hpp"
#include "core/geometry/pixel_conventions.hpp"

namespace stillpoint {
namespace {

#if defined(__x86_64__)
constexpr int kSide = 4, kAtOnce = 8;  // px; blocks

/// Means of a row of blocks of 4x4 px, as OpenCV rounds them: to the even grey level where two are as near.
/// @param blocks a multiple of eight
STILLPOINT_AVX2 void means_of_sixteen(const cv::Mat& gray, int row, int blocks, float* means) {
  const __m256i ones = _mm256_set1_epi8(1), wide_ones = _mm256_set1_epi16(1);
  for (int x = 0; x < blocks; x += kAtOnce) {
    __m256i sum = _mm256_setzero_si256();  // of two columns each
    for (int y = 0; y < kSide; ++y)
      sum = _mm256_add_epi16(
          sum, _mm256_maddubs_epi16(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(
                                        gray.ptr(row * kSide + y) + static_cast<std::ptrdiff_t>(x) * kSide)),
                                    ones));
    sum = _mm256_madd_epi16(sum, wide_ones);
    const __m256i odd = _mm256_and_si256(_mm256_srli_epi32(sum, 4), _mm256_set1_epi32(1));
    const __m256i mean =
        _mm256_srli_epi32(_mm256_add_epi32(_mm256_add_epi32(sum, odd), _mm256_set1_epi32(7)), 4);
    _mm256_storeu_ps(means + x, _mm256_cvtepi32_ps(mean));
  }
}
#endif

/// Grey levels averaged over blocks.
cv::Mat blockwise_gray(const cv::Mat& gray, const cv::Size& size, int factor, [[maybe_unused]] bool wide) {
  const cv::Mat blocks = gray(
      cv::Rect(0, 0, std::min(size.width * factor, gray.cols), std::min(size.height * factor, gray.rows)));
  cv::Mat means(size, CV_32FC1);
#if defined(__x86_64__)
  const bool whole = blocks.cols == kSide * size.width && blocks.rows == kSide * size.height;
  if (wide && factor == kSide && whole && size.width % kAtOnce == 0) {
    for (int y = 0; y < size.height; ++y) means_of_sixteen(blocks, y, size.width, means.ptr<float>(y));
    return means;
  }
#endif
  cv::Mat small;
  cv::resize(blocks, small, size, 0, 0, cv::INTER_AREA);
  small.convertTo(means, CV_32F);
  return means;
}

/// The first measurement of a block that has none in its middle.
float any_depth(const cv::Mat& depth, int x0, int y0, int factor) {
  for (int y = y0; y < std::min(y0 + factor, depth.rows); ++y)
    for (int x = x0; x < std::min(x0 + factor, depth.cols); ++x)
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

constexpr int kLanes = cv::v_float32x4::nlanes;

/// same_surface() of four pixels at once.
cv::v_float32x4 same_surface(const cv::v_float32x4& a, const cv::v_float32x4& b) {
  const cv::v_float32x4 nearer = cv::v_min(a, b);
  return cv::v_abs(a - b) < cv::v_setall_f32(0.02F) + cv::v_setall_f32(0.012F) * nearer * nearer;
}

/// An image whose outermost pixels are 0; all others are yet to be written.
cv::Mat with_zero_rim(const cv::Size& size, int type) {
  cv::Mat image(size, type);
  image.row(0).setTo(0), image.row(size.height - 1).setTo(0);
  image.col(0).setTo(0), image.col(size.width - 1).setTo(0);
  return image;
}

/// RgbdView's `surface` and `depth_slope`.
void describe_surface(RgbdView& view) {
  const cv::Mat &gray = view.gray, &depth = view.depth;
  view.surface = with_zero_rim(depth.size(), CV_32FC4);
  view.depth_slope = with_zero_rim(depth.size(), CV_32FC1);
  if (depth.cols < 3) return;
  const cv::v_float32x4 zero = cv::v_setzero_f32(), quarter = cv::v_setall_f32(0.25F);
  const auto width = static_cast<std::size_t>(depth.cols);
  // A row as it is worked on, with lanes to spare.
  std::vector<float> above(width + kLanes), here(above), below(above), bright_above(above), bright(above),
      bright_below(above), steepest(above), texels(4 * (width + kLanes));
  const auto fill = [width](const cv::Mat& image, int y, std::vector<float>& row) {
    std::copy_n(image.ptr<float>(y), width, row.begin());
  };
  for (int y = 1; y + 1 < depth.rows; ++y) {
    fill(depth, y - 1, above), fill(depth, y, here), fill(depth, y + 1, below);
    fill(gray, y - 1, bright_above), fill(gray, y, bright), fill(gray, y + 1, bright_below);
    for (std::size_t x = 1; x + 1 < width; x += kLanes) {
      const cv::v_float32x4 z = cv::v_load(&here[x]);
      cv::v_float32x4 all = z > zero, step = zero;
      for (const float* beside : {&here[x - 1], &here[x + 1], &above[x], &below[x]}) {
        const cv::v_float32x4 other = cv::v_load(beside), same = (other > zero) & same_surface(z, other);
        all = all & same;
        step = cv::v_max(step, same & cv::v_abs(other - z));
      }
      cv::v_store(&steepest[x], (z > zero) & step);
      const cv::v_float32x4 sideways = quarter * (cv::v_load(&bright[x + 1]) - cv::v_load(&bright[x - 1])),
                            down = quarter * (cv::v_load(&bright_below[x]) - cv::v_load(&bright_above[x]));
      cv::v_store_interleave(&texels[4 * x], sideways, down, cv::v_load(&bright[x]), all & z);
    }
    std::copy_n(&steepest[1], width - 2, view.depth_slope.ptr<float>(y) + 1);
    std::copy_n(&texels[4], 4 * (width - 2), view.surface.ptr<float>(y) + 4);
  }
}

}  // namespace

RgbdView make_rgbd_view(const cv::Mat& gray, const cv::Mat& depth, const Camera& camera, int factor,
                        bool wide) {
  RgbdView view;
  view.factor = factor;
  const cv::Size size(std::max(1, gray.cols / factor), std::max(1, gray.rows / factor));
  view.gray = blockwise_gray(gray, size, factor, wide);
  view.gradient = steepest_neighbour(view.gray);
  view.depth = cv::Mat::zeros(size, CV_32FC1);
  const int middle = factor / 2;
  for (int y = 0; y < size.height && !depth.empty(); ++y) {
    const auto* row = depth.ptr<float>(std::min(y * factor + middle, depth.rows - 1));
    auto* out = view.depth.ptr<float>(y);
    for (int x = 0; x < size.width; ++x) {
      const float centre = row[std::min(x * factor + middle, depth.cols - 1)];
      out[x] = centre > 0 ? centre : any_depth(depth, x * factor, y * factor, factor);
    }
  }
  describe_surface(view);
  view.camera = camera.scaled_to(gray.cols, gray.rows);
  view.camera.fx /= factor, view.camera.fy /= factor;
  view.camera.cx = downsampled(view.camera.cx, factor), view.camera.cy = downsampled(view.camera.cy, factor);
  view.camera.width = size.width, view.camera.height = size.height;
  return view;
}

cv::Mat enlarged(const cv::Mat& small_mask, int factor, const cv::Size& size) {
  cv::Mat mask(size, CV_8UC1);
  for (int y = 0; y < size.height; ++y) {
    auto* out = mask.ptr<uchar>(y);
    if (y % factor != 0 && y / factor < small_mask.rows) {
      std::copy_n(mask.ptr<uchar>(y - 1), size.width, out);
      continue;
    }
    const auto* row = small_mask.ptr<uchar>(std::min(y / factor, small_mask.rows - 1));
    int first = 0;
    if (factor == 4) {  // the usual one: a block's row is one store, not a call
      const int blocks = std::min(size.width / 4, small_mask.cols);
      for (int x = 0; x < blocks; ++x) {
        const std::uint32_t four = 0x01010101U * row[x];
        std::memcpy(out + 4 * static_cast<std::ptrdiff_t>(x), &four, sizeof four);
      }
      first = 4 * blocks;
    }
    for (int x = first; x < size.width; x += factor)
      std::fill_n(out + x, std::min(factor, size.width - x), row[std::min(x / factor, small_mask.cols - 1)]);
  }
  return mask;
}

}  // namespace stillpoint
