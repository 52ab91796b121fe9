#pragma once

#include <Eigen/Core>
#include <concepts>
#include <opencv2/core/types.hpp>
#include <type_traits>
#include <utility>

namespace stillpoint {

// Where a pixel lies: two conventions (P. Heckbert, "What are the coordinates of a pixel?", Graphics Gems,
// 1990).
//
// Pixel coordinates: pixel i has its centre at i, and an image of w pixels reaches from -1/2 to w - 1/2. This
// is OpenCV's convention, and that of features, keypoints, projections and intrinsics: plain numbers,
// Eigen::Vector2d and cv::Point2f.
//
// Raster coordinates: pixel i covers [i, i + 1), its centre is at i + 1/2, and an image of w pixels reaches
// from 0 to w. An image is drawn in these, and only in these is a downsampled frame a plain multiple. They
// are the rarer, so they have types, and no conversion that is not written out.

/// A raster coordinate along one side of an image, px.
template <std::floating_point T>
class RasterCoordinate {
 public:
  constexpr explicit RasterCoordinate(T px) : px_(px) {}
  [[nodiscard]] constexpr T px() const { return px_; }
  /// The same place of the image enlarged, or made smaller, by a factor.
  [[nodiscard]] constexpr RasterCoordinate operator*(T times) const { return RasterCoordinate(px_ * times); }
  [[nodiscard]] constexpr RasterCoordinate operator/(T by) const { return RasterCoordinate(px_ / by); }

 private:
  T px_;
};

/// A point of an image in raster coordinates, px.
class RasterPoint {
 public:
  explicit RasterPoint(double x, double y) : px_(x, y) {}
  explicit RasterPoint(Eigen::Vector2d px) : px_(std::move(px)) {}
  [[nodiscard]] const Eigen::Vector2d& px() const { return px_; }
  [[nodiscard]] RasterPoint operator*(double times) const { return RasterPoint(px_ * times); }
  [[nodiscard]] RasterPoint operator/(double by) const { return RasterPoint(px_ / by); }

 private:
  Eigen::Vector2d px_;
};

/// Pixel coordinates to raster coordinates …
template <std::floating_point T>
[[nodiscard]] constexpr RasterCoordinate<T> to_raster(T pixel) {
  return RasterCoordinate<T>(pixel + T(0.5));
}
[[nodiscard]] inline RasterPoint to_raster(const Eigen::Vector2d& pixel) {
  return RasterPoint((pixel.array() + 0.5).matrix());
}
[[nodiscard]] inline RasterPoint to_raster(const cv::Point2f& pixel) {
  return to_raster(Eigen::Vector2d(static_cast<double>(pixel.x), static_cast<double>(pixel.y)));
}

/// … and back.
template <std::floating_point T>
[[nodiscard]] constexpr T to_pixel(RasterCoordinate<T> raster) {
  return raster.px() - T(0.5);
}
[[nodiscard]] inline Eigen::Vector2d to_pixel(const RasterPoint& raster) {
  return (raster.px().array() - 0.5).matrix();
}

/// The pixel that covers a point.
[[nodiscard]] inline Eigen::Vector2i pixel_covering(const RasterPoint& raster) {
  return raster.px().array().floor().matrix().cast<int>();
}

/// Pixel coordinates of a downsampled frame in the full one, whose pixels are 1 / factor as wide …
template <std::floating_point T>
[[nodiscard]] constexpr T upsampled(T pixel, std::type_identity_t<T> factor) {
  return to_pixel(to_raster(pixel) * factor);
}
[[nodiscard]] inline Eigen::Vector2d upsampled(const Eigen::Vector2d& pixel, double factor) {
  return to_pixel(to_raster(pixel) * factor);
}
[[nodiscard]] inline cv::Point2f upsampled(const cv::Point2f& pixel, float factor) {
  return {upsampled(pixel.x, factor), upsampled(pixel.y, factor)};
}

/// … and the full frame's in a downsampled one.
template <std::floating_point T>
[[nodiscard]] constexpr T downsampled(T pixel, std::type_identity_t<T> factor) {
  return to_pixel(to_raster(pixel) / factor);
}
[[nodiscard]] inline Eigen::Vector2d downsampled(const Eigen::Vector2d& pixel, double factor) {
  return to_pixel(to_raster(pixel) / factor);
}
[[nodiscard]] inline cv::Point2f downsampled(const cv::Point2f& pixel, float factor) {
  return {downsampled(pixel.x, factor), downsampled(pixel.y, factor)};
}

}  // namespace stillpoint
