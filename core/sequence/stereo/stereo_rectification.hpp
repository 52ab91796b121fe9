#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"

namespace stillpoint {

/// Two calibrated cameras as a rectified pair: rows correspond, and the right camera lies straight to the
/// right (Bouguet's method as OpenCV has it, stereoRectify; no pixel is without image).
class StereoRectification {
 public:
  /// @param left,right pinhole cameras with their distortion, of one size
  /// @param where names the pair in messages
  /// @throws InputError where the sizes differ, or the right camera lies not to the right
  StereoRectification(const Camera& left, const Camera& right, const Pose& right_from_left,
                      const std::string& where);

  /// The left camera of the rectified pair, with the baseline.
  [[nodiscard]] const Camera& camera() const { return camera_; }
  /// The turn that rectifying gives the left camera.
  [[nodiscard]] const Pose& left_from_rectified() const { return left_from_rectified_; }
  /// False where the pair is rectified as it is: then images are given back as they are.
  [[nodiscard]] bool resamples() const { return !maps_[0].empty(); }

  enum Side { kLeft = 0, kRight = 1 };
  /// An image of any type, resampled between pixels; one of another size than the cameras' as it is.
  [[nodiscard]] cv::Mat rectified(const cv::Mat& image, Side side) const;

 private:
  Camera camera_;
  Pose left_from_rectified_ = Pose::Identity();
  cv::Mat
      maps_[4];  // of the left, then of the right: whole pixels, and parts of them; empty: none are needed
};

}  // namespace stillpoint
