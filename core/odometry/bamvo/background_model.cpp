#include "core/odometry/bamvo/background_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace stillpoint {
namespace {

constexpr double kQuartile = 0.6744;  // of a normal distribution: half of it lies within so many sigmas

}  // namespace

double foreground_density(double change_m) {
  // The density where every change is its median, 0.6744 sqrt(2) sigmas.
  return kQuartile * std::exp(-kQuartile * kQuartile) / (std::sqrt(std::numbers::pi) * change_m);
}

double background_density(std::vector<float>& changes, double least_sigma_m, double& median) {
  std::sort(changes.begin(), changes.end());
  const std::size_t count = changes.size(), middle = count / 2;
  median = count % 2 == 1
               ? static_cast<double>(changes[middle])
               : 0.5 * (static_cast<double>(changes[middle - 1]) + static_cast<double>(changes[middle]));
  const double sigma = std::max(least_sigma_m, median / (kQuartile * std::numbers::sqrt2));
  double sum = 0.0;
  for (const float change : changes) {
    const double of_sigma = static_cast<double>(change) / sigma;
    sum += std::exp(-0.5 * of_sigma * of_sigma);
  }
  return sum / (static_cast<double>(count) * std::sqrt(2.0 * std::numbers::pi) * sigma);
}

cv::Mat warped_depth(const cv::Mat& depth, const Camera& camera, const Pose& now_from_then) {
  cv::Mat warped(depth.size(), CV_32FC1, cv::Scalar(0));
  for (int y = 0; y < depth.rows; ++y) {
    const float* row = depth.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x) {
      if (row[x] <= 0.0F) continue;
      const Eigen::Vector3d p = now_from_then * camera.back_project({x, y}, static_cast<double>(row[x]));
      if (p.z() <= 0.0) continue;
      const Eigen::Vector2d pixel = camera.project(p);
      const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
      if (u < 0 || v < 0 || u >= depth.cols || v >= depth.rows) continue;
      float& kept = warped.at<float>(v, u);
      const auto z = static_cast<float>(p.z());
      if (kept == 0.0F || z < kept) kept = z;
    }
  }
  return warped;
}

BackgroundModel model_background(const std::vector<PastDepth>& past, const Camera& camera,
                                 const BamvoConfig& config) {
  const cv::Mat& now = past.back().depth;
  BackgroundModel model;
  model.density = cv::Mat(now.size(), CV_32FC1, cv::Scalar(0));
  model.weight = model.density.clone();
  model.foreground = cv::Mat(now.size(), CV_8UC1, cv::Scalar(0));
  model.compared = model.foreground.clone();
  model.median_m = cv::Mat(now.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  std::vector<cv::Mat> warped;
  for (std::size_t i = 0; i + 1 < past.size(); ++i)
    warped.push_back(warped_depth(past[i].depth, camera,
                                  past.back().camera_from_world * past[i].camera_from_world.inverse()));
  const double least = foreground_density(config.foreground_change_m);
  std::vector<float> changes;
  for (int y = 0; y < now.rows; ++y)
    for (int x = 0; x < now.cols; ++x) {
      const float z = now.at<float>(y, x);
      if (z < static_cast<float>(config.nearest_m) || z > static_cast<float>(config.farthest_m)) continue;
      double density = 1.0;
      if (!warped.empty()) {
        changes.clear();
        for (const cv::Mat& depth : warped)
          if (const float then = depth.at<float>(y, x); then > 0.0F) changes.push_back(std::abs(z - then));
        model.compared.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(changes.size());
        if (changes.empty()) continue;
        double median = 0.0;
        density = background_density(changes, config.least_sigma_m, median);
        model.median_m.at<float>(y, x) = static_cast<float>(median);
        if (density < least) model.foreground.at<std::uint8_t>(y, x) = 255;
      }
      model.density.at<float>(y, x) = static_cast<float>(density);
      model.weight.at<float>(y, x) = static_cast<float>(
          config.weigh_by_depth && !warped.empty() ? density * static_cast<double>(z) : density);
    }
  if (warped.empty()) return model;
  cv::Mat smoothed;
  cv::bilateralFilter(model.weight, smoothed, config.bilateral_px, config.bilateral_sigma,
                      config.bilateral_sigma);
  // What is not known does not become so by its neighbours.
  smoothed.setTo(0.0F, model.density == 0.0F);
  model.weight = smoothed;
  return model;
}

}  // namespace stillpoint
