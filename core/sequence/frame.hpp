#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "core/geometry/se3.hpp"

namespace stillpoint {

/// Why a pixel of a stereo pair's left image has no depth.
enum class StereoHole : std::uint8_t {
  none,      ///< it has
  outside,   ///< the right camera does not see so far to the left
  rejected,  ///< no match was clearly the best, or left and right disagree: plain, repeated or hidden
  speckle,   ///< matched, but apart from all about it
  range,     ///< matched nearer or farther than is measured
};

/// What a stereo pair's depth was made of.
struct StereoView {
  cv::Mat right;    ///< CV_8UC1: the right image, rectified
  cv::Mat holes;    ///< CV_8UC1: the StereoHole of each pixel of the left image
  double ms = 0.0;  ///< wall time of matching; for reading only
};

/// One frame as the camera gave it: all a method may see.
struct Frame {
  int index = 0;           ///< place in the sequence, from 0
  std::string name{};      ///< of the colour image's file, without its end; empty where it comes from none
  double timestamp = 0.0;  ///< s, of the colour image
  double depth_timestamp =
      0.0;         ///< s, of the depth image, which sensors take some milliseconds before or after
  cv::Mat colour;  ///< CV_8UC3 BGR as stored; empty when unreadable or the images are grey
  cv::Mat gray;    ///< CV_8UC1; empty only when the frame could not be read
  cv::Mat depth;   ///< CV_32FC1, metres, 0 = no measurement; empty when the frame has none
  std::shared_ptr<const StereoView> stereo{};  ///< what depth was made of; null but for stereo pairs
  std::string
      problem;  ///< why colour or depth is missing or was rejected, one sentence; empty when all is well

  [[nodiscard]] bool readable() const { return !gray.empty(); }
  [[nodiscard]] bool has_depth() const { return !depth.empty(); }
};

/// What is known to be true of a frame. For evaluation and display; no method sees it.
struct FrameTruth {
  std::optional<Pose> world_from_camera;
  cv::Mat moving;  ///< CV_8UC1, 255 = moving, the frame's size; empty where unknown
  cv::Mat depth;   ///< CV_32FC1, m, exact: of generated sequences; empty elsewhere
};

}  // namespace stillpoint
