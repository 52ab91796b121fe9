#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "core/geometry/camera.hpp"

namespace stillpoint {

/// Images as a pinhole camera of the same matrix would have taken them, for engines that align whole images,
/// and back. Copies share its tables. Without distortion it gives images as they are.
class Rectifier {
 public:
  explicit Rectifier(const Camera& camera);

  /// The same camera without distortion.
  [[nodiscard]] const Camera& pinhole() const { return pinhole_; }

  /// Of brightness, between pixels. What the camera did not see becomes black.
  [[nodiscard]] cv::Mat smooth(const cv::Mat& image) const;
  /// Of depth, masks and weights: values that must not be mixed. What the camera did not see becomes 0.
  [[nodiscard]] cv::Mat nearest(const cv::Mat& image) const;
  /// CV_8UC1: 255 where the camera saw; empty: it saw all.
  [[nodiscard]] const cv::Mat& seen() const { return tables_->seen; }

  /// A rectified CV_32FC1 image as the camera's own pixels show it; NaN where no rectified pixel lies.
  [[nodiscard]] cv::Mat to_image(const cv::Mat& rectified) const;
  /// A rectified pixel in the camera's own image.
  [[nodiscard]] cv::Point2f to_image(const cv::Point2f& rectified) const;

 private:
  struct Tables {
    cv::Mat into, back;  // CV_32FC2: where each rectified pixel lies in the image, and the other way
    cv::Mat seen;
  };
  Camera camera_, pinhole_;
  std::shared_ptr<const Tables> tables_;
};

}  // namespace stillpoint
