#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/motion/epipolar/epipolar_config.hpp"

namespace stillpoint {

/// A point followed over several frames.
struct PointTrack {
  std::vector<cv::Point2f>
      path;               ///< px of the downsampled image, newest last; at most far_reference + 1 of them
  int age = 0;            ///< frames followed, also beyond `path`
  float evidence = 0.0F;  ///< of moving
  cv::Matx22f gradients;  ///< summed products of the grey-level gradient about it, (grey levels / px)^2

  /// Where it was `gap` frames ago, or null.
  [[nodiscard]] const cv::Point2f* back(int gap) const {
    return gap < static_cast<int>(path.size()) ? &path[path.size() - 1 - static_cast<std::size_t>(gap)]
                                               : nullptr;
  }
};

/// Points followed from frame to frame by pyramidal Lucas-Kanade (Bouguet 2000), forth and back; each cell of
/// the image has at most one, the one followed longest, and where a cell has none its best corner becomes
/// one.
class PointTracks {
 public:
  /// @param small CV_8UC1
  void advance(const cv::Mat& small, const EpipolarConfig& config);
  void clear();

  [[nodiscard]] const std::vector<PointTrack>& all() const { return tracks_; }
  [[nodiscard]] std::vector<PointTrack>& all() { return tracks_; }
  /// Frames seen since the beginning.
  [[nodiscard]] int frames() const { return frames_; }

 private:
  void follow(const std::vector<cv::Mat>& pyramid, const EpipolarConfig& config);
  void thin_out(cv::Size size, int cell, std::vector<std::uint8_t>& taken);
  void measure_gradients(const cv::Mat& derivatives, int window);
  void plant(const cv::Mat& small, int cell, double quality, std::vector<std::uint8_t>& taken);

  std::vector<PointTrack> tracks_;
  std::vector<cv::Mat> pyramid_;  ///< of the last frame
  int frames_ = 0;
};

}  // namespace stillpoint
