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

}  // namespace stillpoint
