#include "core/sequence/stereo/stereo_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/sequence/image_file.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

constexpr int kMostDisparities = 128;  // px, where the images' width alone decides
constexpr double kShareOfWidth = 0.2;  // … of it
// A side of what is matched: OpenCV advises 3 to 11, and small ones keep outlines.
constexpr int kBlock = 5;    // px
constexpr int kUnique = 10;  // %, by which the best match must be better than the second
constexpr int kSpecklePixels = 100, kSpeckleRange = 2;  // px: of full-size images
constexpr float kLeastDisparity = 1.0F;  // px: farther, the noise of depth is a large part of depth

/// Standard deviation (px) of a disparity, measured on generated rigs against exact truth.
constexpr double kFullSigma = 0.35, kHalfSigma = 0.55;

int rounded_up(double disparities) {
  return kDisparityStep * std::max(1, static_cast<int>(std::ceil(disparities / kDisparityStep)));
}

/// Disparities in sixteenths of a pixel, below 0 where there is none; CV_16SC1.
cv::Mat sixteenths(const cv::Mat& left, const cv::Mat& right, int disparities, bool check) {
  // What lies nearer to the left edge than it is displaced has its match in no image; SGBM would leave out a
  // whole margin.
  cv::Mat wide_left, wide_right, found;
  cv::copyMakeBorder(left, wide_left, 0, 0, disparities, 0, cv::BORDER_REPLICATE);
  cv::copyMakeBorder(right, wide_right, 0, 0, disparities, 0, cv::BORDER_REPLICATE);
  constexpr int kSquare = kBlock * kBlock;
  // OpenCV takes 0 and less for 1: only a difference that no two disparities have switches its check off.
  const int most_difference = check ? 1 : disparities;
  const auto matcher =
      cv::StereoSGBM::create(0, disparities, kBlock, 8 * kSquare, 32 * kSquare, most_difference, 31, kUnique,
                             0, 0, cv::StereoSGBM::MODE_SGBM_3WAY);
  matcher->compute(wide_left, wide_right, found);
  return found.colRange(disparities, found.cols).clone();
}

cv::Mat half_of(const cv::Mat& image) {
  cv::Mat half;
  const cv::Size size(image.cols / 2, image.rows / 2);
  cv::resize(image(cv::Rect(0, 0, 2 * size.width, 2 * size.height)), half, size, 0, 0, cv::INTER_AREA);
  return half;
}

}  // namespace

StereoMatcher::StereoMatcher(const Camera& camera, const StereoOptions& options)
    : camera_(camera), options_(options) {
  disparities_ = options.disparities > 0
                     ? options.disparities
                     : std::min(kMostDisparities, rounded_up(kShareOfWidth * camera.width));
  camera_.depth_sigma_per_m2 = (options.half ? kHalfSigma : kFullSigma) / (camera.fx * camera.baseline_m);
}

StereoMatch StereoMatcher::match(const cv::Mat& left, const cv::Mat& right) const {
  const int factor = options_.half ? 2 : 1;
  const cv::Mat found = options_.half ? sixteenths(half_of(left), half_of(right),
                                                   rounded_up(0.5 * disparities_), options_.left_right_check)
                                      : sixteenths(left, right, disparities_, options_.left_right_check);
  cv::Mat kept = found.clone();
  cv::filterSpeckles(kept, -kDisparityStep, kSpecklePixels / (factor * factor),
                     kSpeckleRange * kDisparityStep / factor);
  StereoMatch result{cv::Mat::zeros(left.size(), CV_32FC1), cv::Mat(left.size(), CV_8UC1)};
  const float unit = static_cast<float>(factor) / static_cast<float>(kDisparityStep);
  const auto most = static_cast<float>(disparities_);
  for (int y = 0; y < left.rows; ++y) {
    const auto *raw = found.ptr<std::int16_t>(std::min(y / factor, found.rows - 1)),
               *clean = kept.ptr<std::int16_t>(std::min(y / factor, found.rows - 1));
    auto* disparity = result.disparity.ptr<float>(y);
    auto* hole = result.holes.ptr<std::uint8_t>(y);
    for (int x = 0; x < left.cols; ++x) {
      const int at = std::min(x / factor, found.cols - 1);
      const float d = unit * static_cast<float>(clean[at]);
      StereoHole kind = StereoHole::none;
      if (raw[at] < 0)
        kind = StereoHole::rejected;
      else if (clean[at] < 0)
        kind = StereoHole::speckle;
      else if (d > static_cast<float>(x))
        kind = StereoHole::outside;
      else if (d < kLeastDisparity || d > most)
        kind = StereoHole::range;
      else
        disparity[x] = d;
      hole[x] = static_cast<std::uint8_t>(kind);
    }
  }
  return result;
}

void StereoMatcher::match(Frame& frame, const cv::Mat& right) const {
  const Stopwatch watch;
  const StereoMatch found = match(frame.gray, to_gray(right));
  auto view = std::make_shared<StereoView>();
  view->right = right;
  view->holes = found.holes;
  frame.depth_timestamp = frame.timestamp;
  if (cv::countNonZero(found.disparity) == 0) {
    frame.problem = "left and right match nowhere: no depth was measured";
  } else {
    cv::divide(camera_.fx * camera_.baseline_m, found.disparity, frame.depth);
    frame.depth.setTo(0, found.disparity == 0);
  }
  view->ms = watch.milliseconds();
  frame.stereo = std::move(view);
}

cv::Mat disparity_of(const cv::Mat& depth, const Camera& camera) {
  cv::Mat disparity;
  cv::divide(camera.fx * camera.baseline_m, depth, disparity);
  disparity.setTo(0, depth == 0);
  return disparity;
}

}  // namespace stillpoint
