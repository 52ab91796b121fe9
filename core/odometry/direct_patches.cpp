#include "core/odometry/direct_patches.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/median.hpp"
#include "core/motion/rgbd_view.hpp"
#include "core/odometry/feature_set.hpp"
#include "core/odometry/rolling_shutter.hpp"

namespace stillpoint {
namespace {

constexpr int kMaskBlock = 4;    // px a side
constexpr int kMarginPx = 12;    // to the image's rim, so that a patch has its pixels at coarse levels too
constexpr float kLeastStep = 3;  // grey levels: beneath it there is but noise

/// Larger of the central differences, times two, of an image of half size.
cv::Mat steepness(const cv::Mat& half) {
  cv::Mat dx, dy;
  cv::Sobel(half, dx, CV_16S, 1, 0, 1);
  cv::Sobel(half, dy, CV_16S, 0, 1, 1);
  dx = cv::abs(dx);
  dy = cv::abs(dy);
  cv::Mat larger;
  cv::max(dx, dy, larger);
  return larger;
}

float median_of_image(const cv::Mat& values) {
  std::vector<std::int16_t> some;
  for (int y = 2; y < values.rows; y += 4)
    for (int x = 2; x < values.cols; x += 4) some.push_back(values.at<std::int16_t>(y, x));
  return static_cast<float>(median_of(some));
}

/// Whether a pixel and what lies about it were measured on one surface: beside an edge, depth is a guess.
bool within_surface(const cv::Mat& depth, int x, int y) {
  constexpr int kReach = 3;  // px to each side
  const float z = depth.at<float>(y, x);
  if (!(z > 0)) return false;
  for (const auto& [dx, dy] : {std::pair{-kReach, 0}, {kReach, 0}, {0, -kReach}, {0, kReach}}) {
    const float other = depth.at<float>(y + dy, x + dx);
    if (!(other > 0) || !same_surface(z, other)) return false;
  }
  return true;
}

}  // namespace

cv::Mat small_mask(const cv::Mat& mask) {
  if (mask.cols < kMaskBlock || mask.rows < kMaskBlock) return {};
  cv::Mat mean;
  cv::resize(mask, mean, {mask.cols / kMaskBlock, mask.rows / kMaskBlock}, 0, 0, cv::INTER_AREA);
  return mean > 0;
}

bool covers(const cv::Mat& small, const cv::Point2f& pixel) {
  const int x = static_cast<int>(pixel.x) / kMaskBlock, y = static_cast<int>(pixel.y) / kMaskBlock;
  return x >= 0 && y >= 0 && x < small.cols && y < small.rows && small.at<std::uint8_t>(y, x) != 0;
}

GreyPyramid grey_pyramid(const cv::Mat& gray, int coarsest_level) {
  constexpr int kLeastSide = 12;  // px of the coarsest level: patches need room to go astray and come back
  GreyPyramid levels{gray};
  while (static_cast<int>(levels.size()) <= coarsest_level &&
         std::min(levels.back().cols, levels.back().rows) >= 2 * kLeastSide) {
    cv::Mat next;
    cv::pyrDown(levels.back(), next);
    levels.push_back(next);
  }
  return levels;
}

std::vector<PatchPoint> choose_patches(const DirectReference& reference, const Camera& camera,
                                       bool rolling_shutter, int cell_px) {
  const cv::Mat& depth = reference.depth;
  if (depth.empty() || depth.size() != reference.gray.size()) return {};
  cv::Mat half;
  cv::pyrDown(reference.gray, half);
  const cv::Mat steep = steepness(half);
  const float least = std::max(kLeastStep, median_of_image(steep));

  std::vector<PatchPoint> chosen;
  std::vector<cv::Point2f> pixels;
  for (int top = 0, row = 0; top + cell_px <= depth.rows; top += cell_px, ++row)
    for (int left = 0, column = 0; left + cell_px <= depth.cols; left += cell_px, ++column) {
      float best = least;
      cv::Point2f place(-1, -1);
      for (int y = std::max(top, kMarginPx); y < std::min(top + cell_px, depth.rows - kMarginPx); y += 2)
        for (int x = std::max(left, kMarginPx); x < std::min(left + cell_px, depth.cols - kMarginPx);
             x += 2) {
          const auto here = static_cast<float>(steep.at<std::int16_t>(y / 2, x / 2));
          const cv::Point2f pixel(static_cast<float>(x), static_cast<float>(y));
          if (here <= best || covers(reference.moving, pixel) || !within_surface(depth, x, y)) continue;
          best = here;
          place = pixel;
        }
      if (place.x < 0) continue;
      pixels.push_back(place);
      chosen.push_back({place, Eigen::Vector3d::Zero(), column, row});
    }

  std::vector<cv::Point2f> undistorted = camera.undistort(pixels);
  std::vector<float> depths = depth_at(pixels, undistorted, depth, camera, reference.velocity, reference.lag);
  if (rolling_shutter) correct_rolling_shutter(camera, reference.velocity, pixels, undistorted, depths);
  for (std::size_t i = 0; i < chosen.size(); ++i)
    chosen[i].point = camera.back_project({undistorted[i].x, undistorted[i].y}, depths[i]);
  std::erase_if(chosen, [](const PatchPoint& p) { return p.point.z() <= 0; });
  return chosen;
}

}  // namespace stillpoint
