#pragma once

#include <opencv2/core.hpp>

#include "core/geometry/camera.hpp"
#include "core/sequence/frame.hpp"
#include "core/sequence/stereo/stereo_options.hpp"

namespace stillpoint {

/// What matching a pair gives, of each pixel of the left image.
struct StereoMatch {
  cv::Mat disparity;  ///< CV_32FC1, px of the full-size images, left less right column; 0 = none
  cv::Mat holes;      ///< CV_8UC1: StereoHole
};

/// Depth of a rectified pair by semi-global matching (Hirschmüller 2008) as OpenCV has it (StereoSGBM). The
/// same pair gives the same bytes, whatever the number of threads. A value: calls may run side by side.
class StereoMatcher {
 public:
  /// @param camera the left one, of the images' size, with its baseline
  StereoMatcher(const Camera& camera, const StereoOptions& options);

  /// The camera, with the noise of the depth that this matcher gives.
  [[nodiscard]] const Camera& camera() const { return camera_; }
  /// px of the full-size images: farther apart left and right are not sought.
  [[nodiscard]] int disparities() const { return disparities_; }
  /// m: nearer than this nothing is measured.
  [[nodiscard]] double nearest_m() const { return camera_.fx * camera_.baseline_m / disparities_; }

  /// @param left,right CV_8UC1, rectified, of the camera's size
  [[nodiscard]] StereoMatch match(const cv::Mat& left, const cv::Mat& right) const;

  /// Matches a frame that has `gray`: its depth, and what that was made of. Where nothing matches the frame
  /// has no depth, and its problem says so.
  /// @param right CV_8UC1 or CV_8UC3, rectified, of the camera's size
  void match(Frame& frame, const cv::Mat& right) const;

 private:
  Camera camera_;
  StereoOptions options_;
  int disparities_ = 0;
};

/// The disparity (px) of each depth (m) of a stereo pair, which is what was matched; 0 where there is none.
/// @param depth CV_32FC1 @return CV_32FC1
[[nodiscard]] cv::Mat disparity_of(const cv::Mat& depth, const Camera& camera);

}  // namespace stillpoint
