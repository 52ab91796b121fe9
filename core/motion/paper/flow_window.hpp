#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>

namespace stillpoint {

// Windows of pyramidal Lucas-Kanade, 21 px a side, by AVX2: for processors that have it (x86-64 alone).
// Numbers are those of Debian 12's OpenCV to the last bit.

constexpr int kWindow = 21;               ///< px a side: OpenCV's own, and the paper's flow is OpenCV's
constexpr std::size_t kLanedPixels = 16;  ///< of a row, summed in lanes
constexpr std::size_t kRestPixels = kWindow - kLanedPixels;  ///< … one after the other
constexpr int kWindowWeightBits = 14;                        ///< the weights of four pixels add up to 1 << 14

/// A row of a window: its grey levels, and how they change along x and y.
struct alignas(32) WindowRow {
  std::array<std::int16_t, 16> laned_gray;                     ///< of pixels 0 4 1 5 2 6 3 7, 8 12 9 13 …
  std::array<std::array<std::int16_t, 16>, 2> laned_gradient;  ///< of eight: x of 0 4 1 5, y, x of 2 6 3 7, y
  std::array<std::int16_t, 16> rest_gray;      ///< of the pixels from kLanedPixels on: four twice, four twice
  std::array<std::int16_t, 16> rest_gradient;  ///< … x of four, y of four, likewise; 0 past the window
};

/// What the gradients of a window sum up to.
struct GradientSums {
  float a11, a12, a22;  ///< sums of dx², dx·dy and dy², scaled
  float rest_most;      ///< for mismatch(): the larger of the sums of dx² and of dy² over the pixels from
                        ///< kLanedPixels on
};

struct Window {
  std::array<WindowRow, kWindow> rows;
};

/// Where a window's first pixel lies in an image, and how the four pixels around are weighed.
struct WindowPlace {
  explicit WindowPlace(const cv::Point2f& at) : corner(cvFloor(at.x), cvFloor(at.y)) {
    const float a = at.x - static_cast<float>(corner.x), b = at.y - static_cast<float>(corner.y);
    constexpr float kOne = 1 << kWindowWeightBits;  // the weight 1 as a whole number
    const int w00 = cvRound((1.0F - a) * (1.0F - b) * kOne);
    const int w01 = cvRound(a * (1.0F - b) * kOne);
    const int w10 = cvRound((1.0F - a) * b * kOne);
    const int w11 = (1 << kWindowWeightBits) - w00 - w01 - w10;
    upper_weights = w00 | w01 << 16;
    lower_weights = w10 | static_cast<int>(static_cast<unsigned>(w11) << 16);
  }
  [[nodiscard]] bool touches(const cv::Mat& image) const {
    return corner.x >= -kWindow && corner.x < image.cols && corner.y >= -kWindow && corner.y < image.rows;
  }
  [[nodiscard]] bool is_on_pixels() const {
    return upper_weights == 1 << kWindowWeightBits && lower_weights == 0;
  }
  cv::Point corner;
  int upper_weights, lower_weights;  ///< two of 16 bits: the left pixel's, and above it the right one's
};

/// The window of `image` at `place`.
/// @param image CV_8UC1 with a window's side of border, @param gradients CV_16SC2 of it
void fill_window(const cv::Mat& image, const cv::Mat& gradients, const WindowPlace& place, Window& window);

[[nodiscard]] GradientSums sum_gradients(const Window& window);

/// What differs between the image at `place` and the window, times the window's gradients, summed and scaled.
/// @param rest_most the window's GradientSums::rest_most
[[nodiscard]] cv::Point2f mismatch(const Window& window, float rest_most, const cv::Mat& image,
                                   const WindowPlace& place);

/// The mean absolute difference between the image at `place` and the window, grey levels.
[[nodiscard]] float mean_difference(const Window& window, const cv::Mat& image, const WindowPlace& place);

}  // namespace stillpoint
