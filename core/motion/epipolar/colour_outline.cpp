#include "core/motion/epipolar/colour_outline.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace stillpoint {
namespace {

constexpr int kShift = 5;                      // of a channel's 8 bits, those that make no difference
constexpr int kOutlineLevels = 256 >> kShift;  // of a channel
constexpr float kPrior = 0.5F;                 // pixels every colour is taken to have besides
constexpr float kMostOutlineSay = 3.0F;        // log-odds of one pixel
constexpr float kSureOutline = 1.0F;           // log-odds from which doubt ends
constexpr int kWindow = 5;                     // px: neighbours decide together

int bin_of(const std::uint8_t* pixel, int channels) {
  int bin = 0;
  for (int c = 0; c < channels; ++c) bin = bin * kOutlineLevels + (pixel[c] >> kShift);
  return bin;
}

}  // namespace

cv::Mat settle_outline(const cv::Mat& image, const cv::Mat& sure, const cv::Mat& maybe, int reach) {
  const int channels = image.channels(),
            bins = channels == 3 ? kOutlineLevels * kOutlineLevels * kOutlineLevels : kOutlineLevels;
  cv::Mat about;
  cv::dilate(maybe, about, cv::getStructuringElement(cv::MORPH_RECT, {2 * reach + 1, 2 * reach + 1}));
  std::vector<float> in(static_cast<std::size_t>(bins), kPrior), out(in);
  float all_in = kPrior * static_cast<float>(bins), all_out = all_in;
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const auto bin = static_cast<std::size_t>(bin_of(image.ptr(y) + x * channels, channels));
      if (sure.at<std::uint8_t>(y, x) != 0)
        in[bin] += 1.0F, all_in += 1.0F;
      else if (about.at<std::uint8_t>(y, x) != 0 && maybe.at<std::uint8_t>(y, x) == 0)
        out[bin] += 1.0F, all_out += 1.0F;
    }
  cv::Mat odds(image.size(), CV_32FC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const auto bin = static_cast<std::size_t>(bin_of(image.ptr(y) + x * channels, channels));
      odds.at<float>(y, x) = std::clamp(std::log(in[bin] / all_in) - std::log(out[bin] / all_out),
                                        -kMostOutlineSay, kMostOutlineSay);
    }
  cv::blur(odds, odds, {kWindow, kWindow});
  cv::Mat settled = (odds > kSureOutline) & maybe;
  settled |= sure;
  return settled;
}

}  // namespace stillpoint
