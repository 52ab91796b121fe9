#include "core/motion/paper/compensation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/motion/paper/gray_warp.hpp"
#include "core/motion/paper/homography.hpp"

namespace stillpoint {
namespace {

/// The x in [0, width) of row y for which every a·x + b·y + c >= 0, as a half-open interval.
struct Span {
  int begin = 0, end = 0;
};

Span row_span(const std::array<cv::Vec3d, 5>& half_planes, int y, int width) {
  double low = 0.0, high = width - 1;
  for (const cv::Vec3d& plane : half_planes) {
    const double offset = plane[1] * y + plane[2];
    if (plane[0] > 0.0) {
      low = std::max(low, -offset / plane[0]);
    } else if (plane[0] < 0.0) {
      high = std::min(high, -offset / plane[0]);
    } else if (offset < 0.0) {
      return {};
    }
  }
  // A millionth of a pixel of slack keeps exact margins exact under rounding.
  if (low > high + 2e-6) return {};
  return {static_cast<int>(std::ceil(low - 1e-6)), static_cast<int>(std::floor(high + 1e-6)) + 1};
}

}  // namespace

cv::Mat valid_area(const cv::Size& size, const cv::Matx33d& homography, int border_px) {
  // A destination pixel p comes from (X/W, Y/W) with (X, Y, W) = G p; "inside" is five half-planes of the
  // destination.
  cv::Matx33d back = homography.inv();
  const double centre_depth = back(2, 0) * size.width / 2 + back(2, 1) * size.height / 2 + back(2, 2);
  if (centre_depth < 0) back *= -1.0;
  const auto row_of = [&back](int i) { return cv::Vec3d(back(i, 0), back(i, 1), back(i, 2)); };
  const cv::Vec3d x = row_of(0), y = row_of(1), w = row_of(2);
  const double low = border_px, right = size.width - 1 - border_px, bottom = size.height - 1 - border_px;
  const std::array<cv::Vec3d, 5> inside = {x - low * w, right * w - x, y - low * w, bottom * w - y, w};

  cv::Mat valid(size, CV_8UC1);
  for (int row = 0; row < size.height; ++row) {
    const Span span = row_span(inside, row, size.width);
    unsigned char* to = valid.ptr(row);
    const int begin = span.end > span.begin ? span.begin : size.width;
    const int end = std::max(span.end, begin);
    std::memset(to, 0, static_cast<std::size_t>(begin));
    std::memset(to + begin, 255, static_cast<std::size_t>(end - begin));
    std::memset(to + end, 0, static_cast<std::size_t>(size.width - end));
  }
  return valid;
}

CompensatedFrame compensate(const cv::Mat& source, const cv::Matx33d& homography, int border_px) {
  CompensatedFrame frame;
  frame.image = warp_gray(source, homography);
  frame.valid = valid_area(source.size(), homography, border_px);
  return frame;
}

cv::Mat warp_mask(const cv::Mat& mask, const cv::Matx33d& homography) {
  cv::Mat carried = cv::Mat::zeros(mask.size(), CV_8UC1);
  const cv::Rect moving = cv::boundingRect(mask);
  if (moving.empty()) return carried;
  // Only the part of the destination that the mask's box can reach is warped. A plausible homography keeps
  // the box a convex quadrilateral.
  const double right = moving.x + moving.width, bottom = moving.y + moving.height;
  std::vector<cv::Point2f> quad;
  for (const cv::Point2d corner : {cv::Point2d(moving.x - 1, moving.y - 1),
                                   {right, moving.y - 1.0},
                                   {right, bottom},
                                   {moving.x - 1.0, bottom}})
    quad.emplace_back(carry(homography, corner));
  const cv::Rect reach = cv::boundingRect(quad) & cv::Rect({0, 0}, mask.size());
  if (reach.empty()) return carried;
  const cv::Matx33d reach_from_image(1, 0, -reach.x, 0, 1, -reach.y, 0, 0, 1);
  cv::Mat part = carried(reach);
  cv::warpPerspective(mask, part, reach_from_image * homography, reach.size(), cv::INTER_NEAREST,
                      cv::BORDER_CONSTANT);
  return carried;
}

}  // namespace stillpoint
