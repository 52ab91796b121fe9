#include "core/odometry/static_weight.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/geometry/pixel_conventions.hpp"

namespace stillpoint {

std::vector<float> static_weights_at(const std::vector<cv::Point2f>& pixels, const cv::Mat& log_odds,
                                     const cv::Size& full, double half) {
  constexpr double kSteepness = 2.0;  // a log-odds more makes weight e² times as unlikely
  std::vector<float> weight(pixels.size(), 1.0F);
  if (log_odds.empty()) return weight;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const int x = std::clamp(cvRound(pixels[i].x) * log_odds.cols / full.width, 0, log_odds.cols - 1);
    const int y = std::clamp(cvRound(pixels[i].y) * log_odds.rows / full.height, 0, log_odds.rows - 1);
    const double odds = static_cast<double>(log_odds.at<float>(y, x)) - half;
    weight[i] = static_cast<float>(1.0 / (1.0 + std::exp(kSteepness * odds)));
  }
  return weight;
}

void raise_least_weight(const std::vector<std::uint8_t>& keep, std::vector<float>& weight) {
  double sum = 0.0;
  int kept = 0;
  for (std::size_t i = 0; i < weight.size(); ++i)
    if (keep[i] != 0) sum += static_cast<double>(weight[i]), ++kept;
  if (kept == 0) return;
  const double unknown = 1.0 - sum / kept;
  const auto least = static_cast<float>(unknown * unknown);
  for (std::size_t i = 0; i < weight.size(); ++i)
    if (keep[i] != 0) weight[i] = std::max(weight[i], least);
}

cv::Mat static_weight_image(const cv::Mat& log_odds, const cv::Size& full, double half) {
  std::vector<cv::Point2f> pixels;
  pixels.reserve(log_odds.total());
  const float step_x = static_cast<float>(full.width) / static_cast<float>(log_odds.cols),
              step_y = static_cast<float>(full.height) / static_cast<float>(log_odds.rows);
  for (int y = 0; y < log_odds.rows; ++y)
    for (int x = 0; x < log_odds.cols; ++x)
      pixels.emplace_back(upsampled(static_cast<float>(x), step_x), upsampled(static_cast<float>(y), step_y));
  std::vector<float> weight = static_weights_at(pixels, log_odds, full, half);
  raise_least_weight(std::vector<std::uint8_t>(weight.size(), 1), weight);
  const cv::Mat small(log_odds.size(), CV_32FC1, weight.data());
  cv::Mat whole;
  cv::resize(small, whole, full, 0, 0, cv::INTER_NEAREST);
  return whole;
}

}  // namespace stillpoint
