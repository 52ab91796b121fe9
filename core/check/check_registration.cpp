#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/check/findings.hpp"
#include "core/sequence/frame.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

constexpr int kRegistrationFrames =
    12;  // spread over the sequence, so that motions of the camera average out
// The farthest shift that is tried, to each side, and from one to the next.
constexpr int kMostShiftPx = 32, kShiftStepPx = 2;
constexpr double kWorthTellingPx = 6.0;  // a Kinect's own registration is off by 2 to 4
constexpr float kFarPx = 8.0F;      // distances to an edge count up to so much: most edges have no partner
constexpr double kBetterBy = 0.10;  // share of the mean distance that the shift takes off
constexpr float kJump = 0.08F;      // of the depth, between neighbours: an outline
constexpr int kFewestEdges = 100;   // px of outlines a frame

/// The near side of outlines in depth.
std::vector<cv::Point> depth_outlines(const cv::Mat& depth) {
  std::vector<cv::Point> edges;
  for (int y = 1; y + 1 < depth.rows; ++y)
    for (int x = 1; x + 1 < depth.cols; ++x) {
      const float z = depth.ptr<float>(y)[x];
      if (z <= 0) continue;
      for (const float other : {depth.ptr<float>(y)[x - 1], depth.ptr<float>(y)[x + 1],
                                depth.ptr<float>(y - 1)[x], depth.ptr<float>(y + 1)[x]})
        if (other > (1.0F + kJump) * z) {
          edges.emplace_back(x, y);
          break;
        }
    }
  return edges;
}

/// Distance (px, up to kFarPx) of each pixel to the nearest edge in brightness.
cv::Mat distance_to_edges(const cv::Mat& gray) {
  constexpr double kWeak = 40.0, kStrong = 100.0;  // Canny's thresholds, grey levels
  cv::Mat edges, distance;
  cv::Canny(gray, edges, kWeak, kStrong);
  const cv::Mat elsewhere = edges == 0;
  cv::distanceTransform(elsewhere, distance, cv::DIST_L2, cv::DIST_MASK_3);
  cv::min(distance, kFarPx, distance);
  return distance;
}

}  // namespace

std::vector<Finding> check_registration(const FrameSource& source) {
  if (!source.has_depth() || source.camera().is_stereo()) return {};
  // Shifts along a side, and which of them is none.
  constexpr int kSide = 2 * (kMostShiftPx / kShiftStepPx) + 1, kMiddle = kSide / 2;
  cv::Mat sum = cv::Mat::zeros(kSide, kSide, CV_64FC1);
  int frames = 0;
  for (int i = 0; i < std::min(kRegistrationFrames, source.size()); ++i) {
    const Frame frame =
        source.read(static_cast<int>(static_cast<long>(i) * source.size() / kRegistrationFrames));
    if (!frame.readable() || !frame.has_depth()) continue;
    std::vector<cv::Point> outlines = depth_outlines(frame.depth);
    // Those that every shift keeps inside, so that all shifts are measured by the same.
    const cv::Rect inside(kMostShiftPx, kMostShiftPx, frame.gray.cols - 2 * kMostShiftPx,
                          frame.gray.rows - 2 * kMostShiftPx);
    std::erase_if(outlines, [&inside](const cv::Point& p) { return !inside.contains(p); });
    if (static_cast<int>(outlines.size()) < kFewestEdges) continue;
    const cv::Mat distance = distance_to_edges(frame.gray);
    for (int v = 0; v < kSide; ++v)
      for (int u = 0; u < kSide; ++u) {
        const cv::Point shift((u - kMiddle) * kShiftStepPx, (v - kMiddle) * kShiftStepPx);
        double total = 0.0;
        for (const cv::Point& p : outlines)
          total += static_cast<double>(distance.ptr<float>(p.y + shift.y)[p.x + shift.x]);
        sum.at<double>(v, u) += total / static_cast<double>(outlines.size());
      }
    ++frames;
  }
  if (frames < kRegistrationFrames / 2) return {};
  double least = 0.0;
  cv::Point at;
  cv::minMaxLoc(sum, &least, nullptr, &at, nullptr);
  const cv::Point shift = (at - cv::Point(kMiddle, kMiddle)) * kShiftStepPx;
  const double as_it_is = sum.at<double>(kMiddle, kMiddle);
  if (std::hypot(shift.x, shift.y) < kWorthTellingPx || least > (1.0 - kBetterBy) * as_it_is) return {};
  return {
      {"depth",
       fmt::format("depth does not lie on colour: its outlines meet the colour images' edges best {} px to "
                   "the {} and {} px {} (mean distance {:.2f} px instead of {:.2f}, over {} frames); it is "
                   "of another camera, or registered by a wrong calibration",
                   std::abs(shift.x), shift.x < 0 ? "left" : "right", std::abs(shift.y),
                   shift.y < 0 ? "up" : "down", least / frames, as_it_is / frames, frames)}};
}

}  // namespace stillpoint
