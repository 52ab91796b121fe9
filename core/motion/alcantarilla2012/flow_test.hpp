#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/motion/alcantarilla2012/alcantarilla2012_config.hpp"
#include "core/motion/residual_motion.hpp"

namespace stillpoint {

// The parts of method `alcantarilla2012`: dense flow both ways, pairs of points in space, their test and the
// vote of a neighbourhood. Images are the frame at half its size: small pixels.

/// Full-size pixels a side of a small one.
inline constexpr int kFlowFactor = 2;

/// Small px: images with a shorter side are not searched.
inline constexpr int kLeastFlowSide = 32;

/// A frame as the method keeps it.
struct FlowImages {
  int index = -1;
  cv::Mat gray;    ///< CV_8UC1, small
  cv::Mat depth;   ///< CV_32FC1, small, m, one measured value of each block of pixels; 0 = none
  PixelRays rays;  ///< of the small pixels
};

/// Dense flow between two frames, small px, CV_32FC2.
struct FlowPair {
  cv::Mat last_from_here;  ///< where a pixel of this frame was in the last, less where it is
  cv::Mat here_from_last;  ///< the other way
};

/// Dense inverse search (Kroeger et al. 2016, OpenCV's "medium"), which stands for the paper's TV-L1. The
/// same whatever the number of threads. @param here, last CV_8UC1 of one size
[[nodiscard]] FlowPair dense_flow(const cv::Mat& here, const cv::Mat& last);

/// A small pixel that can be judged.
struct JudgedPixel {
  int x = 0, y = 0;  ///< small px, in this frame
  ScenePair pair;
};

/// Pixels whose depth can be trusted in both frames, and whose flow there leads back within the limit.
[[nodiscard]] std::vector<JudgedPixel> judged_pixels(const FlowImages& here, const FlowImages& last,
                                                     const FlowPair& flow,
                                                     const Alcantarilla2012Config& config);

/// A round's result, small pixels; NaN where nothing was judged.
struct FlowTest {
  cv::Mat length;       ///< CV_32FC1: |M|, m
  cv::Mat chi_squared;  ///< CV_32FC1: ξ²
  cv::Mat moving;       ///< CV_8UC1: 255 where ξ² is above the limit
  cv::Mat voted;        ///< CV_8UC1: 255 where more than the share of the valid pixels about it is moving
};

[[nodiscard]] FlowTest test_flow(const std::vector<JudgedPixel>& pixels, const cv::Size& size,
                                 const CameraMotion& camera, const SceneFlowNoise& noise,
                                 const Alcantarilla2012Config& config);

/// @param moving, valid CV_8UC1, 0 or 255; `moving` is 0 where `valid` is
/// @return CV_8UC1, 255 where moving pixels are more than `share` of the valid ones in the square of `side`
/// about it
[[nodiscard]] cv::Mat vote(const cv::Mat& moving, const cv::Mat& valid, int side, double share);

}  // namespace stillpoint
