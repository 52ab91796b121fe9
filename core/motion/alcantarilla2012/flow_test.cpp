#include "core/motion/alcantarilla2012/flow_test.hpp"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace stillpoint {
namespace {

/// Flow at a place between pixels, bilinear.
cv::Vec2f flow_at(const cv::Mat& flow, float x, float y) {
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const int right = std::min(left + 1, flow.cols - 1), bottom = std::min(top + 1, flow.rows - 1);
  const float a = x - static_cast<float>(left), b = y - static_cast<float>(top);
  const auto *upper = flow.ptr<cv::Vec2f>(top), *lower = flow.ptr<cv::Vec2f>(bottom);
  return (upper[left] * (1.0F - a) + upper[right] * a) * (1.0F - b) +
         (lower[left] * (1.0F - a) + lower[right] * a) * b;
}

}  // namespace

FlowPair dense_flow(const cv::Mat& here, const cv::Mat& last) {
  const auto search = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM);
  FlowPair flow;
  // The search reads whole images in one piece.
  const cv::Mat a = here.isContinuous() ? here : here.clone(), b = last.isContinuous() ? last : last.clone();
  search->calc(a, b, flow.last_from_here);
  search->calc(b, a, flow.here_from_last);
  return flow;
}

std::vector<JudgedPixel> judged_pixels(const FlowImages& here, const FlowImages& last, const FlowPair& flow,
                                       const Alcantarilla2012Config& config) {
  std::vector<JudgedPixel> pixels;
  const cv::Size size = here.gray.size();
  pixels.reserve(static_cast<std::size_t>(size.area()));
  const auto nearest = static_cast<float>(config.least_depth_m),
             farthest = static_cast<float>(config.most_depth_m);
  const auto limit = static_cast<float>(config.forward_backward_px / kFlowFactor);
  const auto trusted = [&](float z) { return z > 0.0F && z >= nearest && z <= farthest; };
  for (int y = 1; y + 1 < size.height; ++y) {
    const auto* back = flow.last_from_here.ptr<cv::Vec2f>(y);
    for (int x = 1; x + 1 < size.width; ++x) {
      const float there_x = static_cast<float>(x) + back[x][0], there_y = static_cast<float>(y) + back[x][1];
      // Also false for NaN.
      if (!(there_x >= 0.0F && there_y >= 0.0F && there_x <= static_cast<float>(size.width - 1) &&
            there_y <= static_cast<float>(size.height - 1)))
        continue;
      const cv::Vec2f miss = back[x] + flow_at(flow.here_from_last, there_x, there_y);
      if (!(miss.dot(miss) <= limit * limit)) continue;
      JudgedPixel pixel{x, y, {}};
      ScenePair& pair = pixel.pair;
      pair.z_here = surface_depth(here.depth, static_cast<float>(x), static_cast<float>(y));
      if (!trusted(pair.z_here)) continue;
      pair.z_last = surface_depth(last.depth, there_x, there_y);
      if (!trusted(pair.z_last)) continue;
      pair.ray_here = here.rays.at(static_cast<float>(x), static_cast<float>(y));
      pair.ray_last = last.rays.at(there_x, there_y);
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

FlowTest test_flow(const std::vector<JudgedPixel>& pixels, const cv::Size& size, const CameraMotion& camera,
                   const SceneFlowNoise& noise, const Alcantarilla2012Config& config) {
  const cv::Scalar nothing(std::numeric_limits<float>::quiet_NaN());
  FlowTest test{
      cv::Mat(size, CV_32FC1, nothing), cv::Mat(size, CV_32FC1, nothing), cv::Mat::zeros(size, CV_8UC1), {}};
  cv::Mat valid = cv::Mat::zeros(size, CV_8UC1);
  const auto limit = static_cast<float>(config.chi_squared);
  for (const JudgedPixel& pixel : pixels) {
    const ResidualMotion residual = residual_motion(pixel.pair, camera, noise);
    const float squared = residual.chi_squared();
    test.length.at<float>(pixel.y, pixel.x) = residual.motion.norm();
    test.chi_squared.at<float>(pixel.y, pixel.x) = squared;
    valid.at<std::uint8_t>(pixel.y, pixel.x) = 255;
    if (squared > limit) test.moving.at<std::uint8_t>(pixel.y, pixel.x) = 255;
  }
  test.voted = vote(test.moving, valid, config.vote_px, config.vote_share);
  return test;
}

cv::Mat vote(const cv::Mat& moving, const cv::Mat& valid, int side, double share) {
  const cv::Size window(side, side);
  cv::Mat movers, voters;
  // Sums of 0 and 255: shares are the same. Beyond the image nobody votes.
  cv::boxFilter(moving, movers, CV_32S, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::boxFilter(valid, voters, CV_32S, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::Mat voted(moving.size(), CV_8UC1);
  for (int y = 0; y < voted.rows; ++y) {
    const auto *mover = movers.ptr<int>(y), *voter = voters.ptr<int>(y);
    auto* out = voted.ptr<std::uint8_t>(y);
    for (int x = 0; x < voted.cols; ++x)
      out[x] =
          static_cast<double>(mover[x]) > share * static_cast<double>(voter[x]) && mover[x] > 0 ? 255 : 0;
  }
  return voted;
}

}  // namespace stillpoint
