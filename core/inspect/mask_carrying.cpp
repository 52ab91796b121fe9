#include "core/inspect/mask_carrying.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace stillpoint {
namespace {

constexpr int kCertain = 3;           // px inside the carried outline that are taken as the object's
constexpr int kReach = 7;             // px outside it that may be the object's after all
constexpr int kWindow = 31;           // px a side: over so much the two sides' depths are averaged
constexpr float kApart = 0.05F;       // m between the sides' depths, from which on depth decides
constexpr float kApartShare = 0.02F;  // … and of the depth itself, as sensors see less exactly far away

cv::Mat grown(const cv::Mat& mask, int by) {
  cv::Mat result;
  cv::dilate(mask, result, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * by + 1, 2 * by + 1}));
  return result;
}

cv::Mat shrunk(const cv::Mat& mask, int by) {
  // The image's end is no outline: what reaches it goes on behind it.
  cv::Mat result;
  cv::erode(mask, result, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * by + 1, 2 * by + 1}));
  return result;
}

/// Mean depth (m) of the measured pixels of `region` about each pixel; 0 where there is none.
cv::Mat mean_depth(const cv::Mat& depth, const cv::Mat& region) {
  cv::Mat of_region = cv::Mat::zeros(depth.size(), CV_32FC1), counted, sum, count;
  const cv::Mat measured = region & (depth > 0);
  depth.copyTo(of_region, measured);
  measured.convertTo(counted, CV_32F, 1.0 / 255.0);
  cv::boxFilter(of_region, sum, CV_32F, {kWindow, kWindow}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::boxFilter(counted, count, CV_32F, {kWindow, kWindow}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::Mat mean = cv::Mat::zeros(depth.size(), CV_32FC1);
  cv::divide(sum, count, mean);
  mean.setTo(0.0, count < 0.5);
  return mean;
}

/// The mask's outline, drawn to where depth steps.
void fit_outline(const cv::Mat& depth, cv::Mat& mask) {
  const cv::Mat inside = shrunk(mask, kCertain), about = grown(mask, kReach);
  const cv::Mat object = mean_depth(depth, inside), behind = mean_depth(depth, ~about);
  for (int y = 0; y < mask.rows; ++y) {
    const auto *z = depth.ptr<float>(y), *near = object.ptr<float>(y), *far = behind.ptr<float>(y);
    const auto *sure = inside.ptr<uchar>(y), *maybe = about.ptr<uchar>(y);
    auto* out = mask.ptr<uchar>(y);
    for (int x = 0; x < mask.cols; ++x) {
      if (sure[x] != 0 || maybe[x] == 0 || z[x] <= 0 || near[x] <= 0 || far[x] <= 0) continue;
      if (std::abs(near[x] - far[x]) < kApart + kApartShare * z[x]) continue;
      out[x] = std::abs(z[x] - near[x]) < std::abs(z[x] - far[x]) ? 255 : 0;
    }
  }
  // Single pixels of noise, not what is thin.
  cv::medianBlur(mask, mask, 5);
}

/// Distance (px) to the outline, positive inside the mask.
cv::Mat signed_distance(const cv::Mat& mask) {
  cv::Mat inside, outside;
  const cv::Mat rest = ~mask;
  cv::distanceTransform(mask, inside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::distanceTransform(rest, outside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return inside - outside;
}

}  // namespace

cv::Mat carried_mask(const Frame& from, const cv::Mat& mask, const Frame& to) {
  if (cv::countNonZero(mask) == 0) return cv::Mat::zeros(to.gray.size(), CV_8UC1);
  cv::Mat flow;
  cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM)->calc(to.gray, from.gray, flow);
  for (int y = 0; y < flow.rows; ++y) {
    auto* at = flow.ptr<cv::Vec2f>(y);
    for (int x = 0; x < flow.cols; ++x) at[x] += cv::Vec2f(static_cast<float>(x), static_cast<float>(y));
  }
  cv::Mat carried;
  cv::remap(mask, carried, flow, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  carried = carried > 127;
  if (to.has_depth()) fit_outline(to.depth, carried);
  return carried;
}

cv::Mat blended_mask(const cv::Mat& earlier, const cv::Mat& later, double share) {
  // Without an outline there is no distance to it: the nearer of the two stands.
  if (cv::countNonZero(earlier) == 0 || cv::countNonZero(later) == 0)
    return (share < 0.5 ? earlier : later).clone();
  return (1.0 - share) * signed_distance(earlier) + share * signed_distance(later) > 0.0;
}

}  // namespace stillpoint
