#include "core/motion/gao2019/sparse_alignment.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/geometry/normal_equations.hpp"
#include "core/geometry/pixel_conventions.hpp"
#include "core/motion/residual_motion.hpp"

namespace stillpoint {
namespace {

constexpr std::size_t kPixels = kPatchSide * kPatchSide;
constexpr double kNearest = 0.05;    // m: nearer points are not projected
constexpr double kLeastSigma = 1.5;  // grey levels: no image is less noisy
constexpr double kTukey = 3.0;       // a patch whose RMS is beyond so many deviations has no say
constexpr double kEnough = 1e-5;     // m and rad: a shorter step is the last one

/// Grey level between pixels, bilinear; the place lies at least a pixel within the image.
float level_at(const cv::Mat& image, float x, float y) {
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const float a = x - static_cast<float>(left), b = y - static_cast<float>(top);
  const auto *upper = image.ptr<std::uint8_t>(top) + left, *lower = image.ptr<std::uint8_t>(top + 1) + left;
  const auto mix = [a](const std::uint8_t* row) {
    return static_cast<float>(row[0]) * (1.0F - a) + static_cast<float>(row[1]) * a;
  };
  return mix(upper) * (1.0F - b) + mix(lower) * b;
}

/// Where a full-size place lies in a level whose pixels are `scale` of it: the left upper pixel of its patch.
cv::Point2f corner_in_level(const cv::Point2f& full, float scale) {
  // From a patch's first pixel to its middle, px.
  constexpr float kMiddle = 0.5F * static_cast<float>(kPatchSide - 1);
  return upsampled(full, scale) - cv::Point2f(kMiddle, kMiddle);
}

bool patch_fits(const cv::Point2f& corner, const cv::Size& size) {
  constexpr float kRoom = 1.0F;  // for slopes and interpolation
  return corner.x >= kRoom && corner.y >= kRoom &&
         corner.x + static_cast<float>(kPatchSide) + kRoom < static_cast<float>(size.width) &&
         corner.y + static_cast<float>(kPatchSide) + kRoom < static_cast<float>(size.height);
}

struct Patch {
  std::size_t index = 0;  // of the point
  std::array<float, kPixels> value{};
  std::array<Vector6d, kPixels> jacobian;  // of the last frame's grey levels, by a motion of its points
};

std::vector<Patch> patches_of(const cv::Mat& image, const std::vector<AlignmentPoint>& points, int level,
                              const Camera& camera) {
  std::vector<Patch> patches;
  const float scale = 1.0F / static_cast<float>(1 << level);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point2f corner = corner_in_level(points[i].pixel, scale);
    if (!patch_fits(corner, image.size())) continue;
    const Eigen::Vector3d& p = points[i].point;
    const double inverse = 1.0 / p.z(), fx = camera.fx * static_cast<double>(scale),
                 fy = camera.fy * static_cast<double>(scale);
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << fx * inverse, 0.0, -fx * p.x() * inverse * inverse, 0.0, fy * inverse,
        -fy * p.y() * inverse * inverse;
    Eigen::Matrix<double, 2, 6> by_motion;
    by_motion << by_point, -by_point * hat(p);
    Patch patch;
    patch.index = i;
    for (int k = 0; k < static_cast<int>(kPixels); ++k) {
      const float x = corner.x + static_cast<float>(k % kPatchSide),
                  y = corner.y + static_cast<float>(k / kPatchSide);
      const auto at = static_cast<std::size_t>(k);
      patch.value[at] = level_at(image, x, y);
      const double slope_x = 0.5 * static_cast<double>(level_at(image, x + 1, y) - level_at(image, x - 1, y));
      const double slope_y = 0.5 * static_cast<double>(level_at(image, x, y + 1) - level_at(image, x, y - 1));
      patch.jacobian[at] = (slope_x * by_motion.row(0) + slope_y * by_motion.row(1)).transpose();
    }
    patches.push_back(patch);
  }
  return patches;
}

/// Where a point of the last frame lies in this one's image; NaN where it is not before the camera.
cv::Point2f place_of(const Eigen::Vector3d& point, const Pose& here_from_last, const Camera& camera) {
  constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();
  const Eigen::Vector3d p = here_from_last * point;
  if (p.z() < kNearest) return {kNowhere, kNowhere};
  const Eigen::Vector2d straight = camera.project(p);
  const Eigen::Vector2d pixel = camera.has_distortion() ? camera.distort(straight) : straight;
  return {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}

float median_of_copy(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The patches' differences under a motion.
struct Comparison {
  std::vector<float> residuals;      // grey levels, kPixels a patch in view, their median taken off
  std::vector<std::size_t> in_view;  // which patches
  double sigma = kLeastSigma;
};

Comparison compare(const std::vector<Patch>& patches, const std::vector<AlignmentPoint>& points,
                   const cv::Mat& image, float scale, const Pose& here_from_last, const Camera& camera) {
  Comparison comparison;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const cv::Point2f corner =
        corner_in_level(place_of(points[patches[i].index].point, here_from_last, camera), scale);
    if (!patch_fits(corner, image.size())) continue;  // NaN neither
    comparison.in_view.push_back(i);
    for (int k = 0; k < static_cast<int>(kPixels); ++k)
      comparison.residuals.push_back(level_at(image, corner.x + static_cast<float>(k % kPatchSide),
                                              corner.y + static_cast<float>(k / kPatchSide)) -
                                     patches[i].value[static_cast<std::size_t>(k)]);
  }
  if (comparison.residuals.empty()) return comparison;
  const float offset = median_of_copy(comparison.residuals);
  std::vector<float> sizes;
  sizes.reserve(comparison.residuals.size());
  for (float& residual : comparison.residuals) sizes.push_back(std::abs(residual -= offset));
  comparison.sigma = std::max(kLeastSigma, 1.4826 * static_cast<double>(median_of_copy(std::move(sizes))));
  return comparison;
}

/// A step of Gauss-Newton: of the last frame's points.
Vector6d step_of(const std::vector<Patch>& patches, const Comparison& comparison) {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  const float* residual = comparison.residuals.data();
  for (const std::size_t i : comparison.in_view) {
    // A patch on something that moves is off as a whole: it is weighed as one.
    double squared = 0.0;
    for (std::size_t k = 0; k < kPixels; ++k)
      squared += static_cast<double>(residual[k]) * static_cast<double>(residual[k]);
    const double off = squared / (static_cast<double>(kPixels) * comparison.sigma * comparison.sigma);
    const double left = 1.0 - off / (kTukey * kTukey), weight = left > 0.0 ? left * left : 0.0;
    for (std::size_t k = 0; k < kPixels && weight > 0.0; ++k) {
      const Vector6d& jacobian = patches[i].jacobian[k];
      hessian.noalias() += weight * jacobian * jacobian.transpose();
      gradient += weight * static_cast<double>(residual[k]) * jacobian;
    }
    residual += kPixels;
  }
  return solve_ldlt(hessian, gradient);
}

}  // namespace

AlignmentPyramid alignment_pyramid(const cv::Mat& gray, int coarsest_level) {
  AlignmentPyramid pyramid{gray};
  while (static_cast<int>(pyramid.size()) <= coarsest_level) {
    const cv::Mat& finer = pyramid.back();
    if (std::min(finer.cols, finer.rows) < 4 * kPatchSide) break;
    cv::Mat coarser;
    cv::resize(finer, coarser, {finer.cols / 2, finer.rows / 2}, 0, 0, cv::INTER_AREA);
    pyramid.push_back(coarser);
  }
  return pyramid;
}

std::vector<AlignmentPoint> corner_points(const cv::Mat& gray, const cv::Mat& depth, const Camera& camera,
                                          const Gao2019Config& config) {
  std::vector<AlignmentPoint> points;
  if (depth.empty()) return points;
  std::vector<cv::KeyPoint> corners;
  cv::FAST(gray, corners, config.fast_threshold, true);
  const int columns = gray.cols / config.cell_px + 1, rows = gray.rows / config.cell_px + 1;
  std::vector<const cv::KeyPoint*> best(static_cast<std::size_t>(columns * rows), nullptr);
  for (const cv::KeyPoint& corner : corners) {
    const cv::KeyPoint*& held =
        best[static_cast<std::size_t>(static_cast<int>(corner.pt.y) / config.cell_px * columns +
                                      static_cast<int>(corner.pt.x) / config.cell_px)];
    // Of equals the first in reading order.
    if ((held == nullptr || corner.response > held->response) &&
        surface_depth(depth, corner.pt.x, corner.pt.y) > 0.0F)
      held = &corner;
  }
  std::vector<cv::Point2f> pixels;
  for (const cv::KeyPoint* corner : best)
    if (corner != nullptr) pixels.push_back(corner->pt);
  if (pixels.empty()) return points;
  const std::vector<cv::Point2f> straight = camera.undistort(pixels);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    points.push_back({pixels[i], camera.back_project(
                                     {static_cast<double>(straight[i].x), static_cast<double>(straight[i].y)},
                                     static_cast<double>(surface_depth(depth, pixels[i].x, pixels[i].y)))});
  return points;
}

SparseAlignment align_sparsely(const AlignmentPyramid& last, const std::vector<AlignmentPoint>& points,
                               const AlignmentPyramid& here, const Pose& start, const Camera& camera,
                               const Gao2019Config& config) {
  SparseAlignment result;
  result.here_from_last = start;
  result.patches = static_cast<int>(points.size());
  const int coarsest = static_cast<int>(std::min(last.size(), here.size())) - 1;
  for (int level = std::min(coarsest, config.coarsest_level);
       level >= std::min(config.finest_level, coarsest); --level) {
    const std::vector<Patch> patches =
        patches_of(last[static_cast<std::size_t>(level)], points, level, camera);
    const cv::Mat& image = here[static_cast<std::size_t>(level)];
    const float scale = 1.0F / static_cast<float>(1 << level);
    for (int i = 0; i < config.iterations; ++i) {
      const Comparison comparison = compare(patches, points, image, scale, result.here_from_last, camera);
      result.in_view = static_cast<int>(comparison.in_view.size());
      result.sigma = comparison.sigma;
      if (result.in_view < config.min_patches) {
        result.here_from_last = start;
        result.note = fmt::format("only {} patches are in view; {} are needed to align", result.in_view,
                                  config.min_patches);
        return result;
      }
      const Vector6d step = step_of(patches, comparison);
      if (!step.allFinite() || step.norm() > 1.0) {
        result.here_from_last = start;
        result.note = "image alignment went astray";
        return result;
      }
      // What the last frame's points would have to move by is the other way round for the camera.
      result.here_from_last = normalised(result.here_from_last * se3_exp(-step));
      ++result.iterations;
      if (step.norm() < kEnough) break;
    }
  }
  result.found = true;
  for (const AlignmentPoint& point : points)
    result.here.push_back(place_of(point.point, result.here_from_last, camera));
  return result;
}

}  // namespace stillpoint
