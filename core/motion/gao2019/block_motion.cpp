#include "core/motion/gao2019/block_motion.hpp"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/geometry/pixel_conventions.hpp"

namespace stillpoint {
namespace {

/// How many of the eight neighbours are set.
cv::Mat set_neighbours(const cv::Mat& blocks) {
  cv::Mat ones = blocks / 255, all;
  cv::boxFilter(ones, all, CV_8U, {3, 3}, {-1, -1}, false, cv::BORDER_CONSTANT);
  return all - ones;
}

}  // namespace

cv::Mat block_depths(const cv::Mat& depth, const cv::Size& blocks, int block_px) {
  cv::Mat depths = cv::Mat::zeros(blocks, CV_32FC1);
  if (depth.empty()) return depths;
  const std::size_t least = static_cast<std::size_t>(std::max(1, block_px * block_px / 4));
  std::vector<float> measured;
  for (int by = 0; by < blocks.height; ++by)
    for (int bx = 0; bx < blocks.width; ++bx) {
      measured.clear();
      for (int y = by * block_px; y < (by + 1) * block_px; ++y) {
        const auto* row = depth.ptr<float>(y);
        for (int x = bx * block_px; x < (bx + 1) * block_px; ++x)
          if (row[x] > 0.0F) measured.push_back(row[x]);
      }
      if (measured.size() < least) continue;
      const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
      std::nth_element(measured.begin(), middle, measured.end());
      depths.at<float>(by, bx) = *middle;
    }
  return depths;
}

Yi2013Places places_by_depth(const cv::Mat& depths, const PixelRays& rays, const Pose& last_from_here,
                             const Camera& camera, int block_px, const Yi2013Places& by_homography) {
  constexpr double kNearest = 0.05;  // m: nearer points are not projected
  constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  Yi2013Places places = by_homography;
  for (int by = 0; by < depths.rows; ++by)
    for (int bx = 0; bx < depths.cols; ++bx) {
      const auto z = static_cast<double>(depths.at<float>(by, bx));
      if (z <= 0.0) continue;
      const Eigen::Vector2d ray = rays.at(static_cast<float>(bx), static_cast<float>(by)).cast<double>();
      const Eigen::Vector3d there = last_from_here * Eigen::Vector3d(ray.x() * z, ray.y() * z, z);
      RasterPoint& place = places[static_cast<std::size_t>(by * depths.cols + bx)];
      if (there.z() < kNearest) {
        place = RasterPoint(kNowhere, kNowhere);
        continue;
      }
      const Eigen::Vector2d straight = camera.project(there);
      const Eigen::Vector2d pixel = camera.has_distortion() ? camera.distort(straight) : straight;
      place = to_raster(pixel) / block_px;
    }
  return places;
}

cv::Mat block_deviations(const Yi2013Blocks& blocks, const Yi2013Model& chosen, const Yi2013Model& updated,
                         double settled_age) {
  cv::Mat deviations(blocks.mean.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  for (int y = 0; y < deviations.rows; ++y)
    for (int x = 0; x < deviations.cols; ++x) {
      if (static_cast<double>(chosen[0].age.at<float>(y, x)) <= settled_age) continue;
      const float mean = updated[0].mean.at<float>(y, x);
      const float down = mean - static_cast<float>(blocks.least.at<std::uint8_t>(y, x)),
                  up = static_cast<float>(blocks.most.at<std::uint8_t>(y, x)) - mean;
      deviations.at<float>(y, x) = std::max(down * down, up * up) / chosen[0].variance.at<float>(y, x);
    }
  return deviations;
}

double exposure_gain(const Yi2013Blocks& blocks, const Yi2013Model& warped, double settled_age) {
  constexpr float kDark = 16.0F, kWhite = 230.0F;  // grey levels: ratios tell nothing there
  constexpr std::size_t kLeast = 50;               // blocks: a median of fewer follows what moves
  std::vector<float> ratios;
  for (int y = 0; y < blocks.mean.rows; ++y)
    for (int x = 0; x < blocks.mean.cols; ++x) {
      const float seen = blocks.mean.at<float>(y, x), mean = warped[0].mean.at<float>(y, x);
      const bool judges = static_cast<double>(warped[0].age.at<float>(y, x)) > settled_age;
      if (judges && std::min(seen, mean) > kDark && std::max(seen, mean) < kWhite)
        ratios.push_back(seen / mean);
    }
  if (ratios.size() < kLeast) return 1.0;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return static_cast<double>(*middle);
}

void brighten(Yi2013Model& model, double gain) {
  // What is nearly white may have been cut off, and nothing is above white.
  constexpr float kWhite = 245.0F, kWhitest = 255.0F;  // grey levels
  for (Yi2013Gaussians& gaussians : model)
    for (int y = 0; y < gaussians.mean.rows; ++y) {
      auto* mean = gaussians.mean.ptr<float>(y);
      for (int x = 0; x < gaussians.mean.cols; ++x)
        if (mean[x] < kWhite) mean[x] = std::min(kWhitest, static_cast<float>(gain) * mean[x]);
    }
}

cv::Mat clean_blocks(const cv::Mat& moving, bool drop_isolated, int fill_neighbours) {
  cv::Mat cleaned = moving.clone();
  if (drop_isolated) cleaned.setTo(0, set_neighbours(moving) == 0);
  const cv::Mat filled = set_neighbours(cleaned) >= fill_neighbours;
  cleaned.setTo(255, filled);
  return cleaned;
}

cv::Mat mask_of_blocks(const cv::Mat& blocks, int block_px, const cv::Size& frame) {
  cv::Mat mask = cv::Mat::zeros(frame, CV_8UC1);
  cv::Mat covered = mask(cv::Rect(0, 0, blocks.cols * block_px, blocks.rows * block_px));
  cv::resize(blocks, covered, covered.size(), 0, 0, cv::INTER_NEAREST);
  return mask;
}

}  // namespace stillpoint
