#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/pixel_conventions.hpp"
#include "core/geometry/se3.hpp"
#include "core/odometry/masked_engine.hpp"
#include "core/odometry/ptam/ptam_config.hpp"

namespace stillpoint {

/// A frame as PTAM searches it: four sizes with their corners, and a small blurred image.
struct PtamImage final : TrackerPreparation {
  std::array<cv::Mat, PtamConfig::kLevels> levels;                  ///< CV_8UC1, each half the last
  std::array<std::vector<cv::Point>, PtamConfig::kLevels> corners;  ///< all FAST corners, row by row
  std::array<std::vector<int>, PtamConfig::kLevels> row_begin;      ///< into corners, rows + 1 of them
  cv::Mat small;                                                    ///< CV_32FC1, blurred, mean taken off
};

[[nodiscard]] std::shared_ptr<const PtamImage> make_ptam_image(const cv::Mat& gray, const PtamConfig& config);

/// A pixel of the full image as one of a level, and back.
[[nodiscard]] inline Eigen::Vector2d to_level(const Eigen::Vector2d& pixel, int level) {
  return downsampled(pixel, 1 << level);
}
[[nodiscard]] inline Eigen::Vector2d from_level(const Eigen::Vector2d& pixel, int level) {
  return upsampled(pixel, 1 << level);
}

/// Smaller eigenvalue of the gradients' scatter over 7x7 px: Shi & Tomasi's score.
[[nodiscard]] double shi_tomasi(const cv::Mat& level, const cv::Point& at);

/// The turn that lays one small image on another, by Gauss-Newton; by how much they differ afterwards.
struct SmallTurn {
  Eigen::Matrix3d now_from_then = Eigen::Matrix3d::Identity();
  double difference = 0.0;  ///< grey levels², a pixel
};
[[nodiscard]] SmallTurn turn_between(const cv::Mat& then, const cv::Mat& now, const Camera& full);

constexpr int kPatch = 8;  ///< px a side

/// An 8x8 patch of a keyframe, as another view should show it.
struct PtamPatch {
  int level = 0;                                ///< at which it is searched
  std::array<float, kPatch * kPatch> values{};  ///< grey levels
  double mean = 0.0;

  /// Mean squared difference to a patch about a pixel (its corner at -4), means taken off; infinite where
  /// that leaves the image.
  [[nodiscard]] double difference(const cv::Mat& image, const cv::Point& at) const;
};

/// The level of a view at which a patch has about its own size, and the patch warped into it.
/// @param warp derivative of the view's full pixels by the source level's
/// @returns nothing where it would be far larger or smaller, or leaves its keyframe
[[nodiscard]] std::optional<PtamPatch> warped_patch(const cv::Mat& source, const cv::Point& at,
                                                    const Eigen::Matrix2d& warp);

struct PtamFound {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< px, full image
  double difference = 0.0;
  bool subpixel = false;
};

/// Looks for a patch at the corners about a place. @param radius_px of the full image
[[nodiscard]] std::optional<PtamFound> search_patch(const PtamPatch& patch, const PtamImage& image,
                                                    const Eigen::Vector2d& about, double radius_px,
                                                    double limit, int subpixel_steps);

}  // namespace stillpoint
