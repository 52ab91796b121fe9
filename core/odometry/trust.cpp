#include "core/odometry/trust.hpp"

#include <algorithm>
#include <cmath>

namespace stillpoint {

std::vector<float> trust_at(const std::vector<cv::Point2f>& pixels, const cv::Mat& log_odds,
                            const cv::Size& full, double half) {
  constexpr double kSteepness = 2.0;  // a log-odds more makes trust e² times as unlikely
  std::vector<float> trust(pixels.size(), 1.0F);
  if (log_odds.empty()) return trust;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const int x = std::clamp(cvRound(pixels[i].x) * log_odds.cols / full.width, 0, log_odds.cols - 1);
    const int y = std::clamp(cvRound(pixels[i].y) * log_odds.rows / full.height, 0, log_odds.rows - 1);
    const double odds = static_cast<double>(log_odds.at<float>(y, x)) - half;
    trust[i] = static_cast<float>(1.0 / (1.0 + std::exp(kSteepness * odds)));
  }
  return trust;
}

void raise_least_trust(const std::vector<std::uint8_t>& keep, std::vector<float>& trust) {
  double sum = 0.0;
  int kept = 0;
  for (std::size_t i = 0; i < trust.size(); ++i)
    if (keep[i] != 0) sum += static_cast<double>(trust[i]), ++kept;
  if (kept == 0) return;
  const double unknown = 1.0 - sum / kept;
  const auto least = static_cast<float>(unknown * unknown);
  for (std::size_t i = 0; i < trust.size(); ++i)
    if (keep[i] != 0) trust[i] = std::max(trust[i], least);
}

}  // namespace stillpoint
