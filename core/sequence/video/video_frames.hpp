#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/media/media_module.hpp"

namespace stillpoint {

/// The frames of a video by index. Containers seek to a key frame near a place and give no promise which
/// frame comes next, so frames are decoded one after another from the first: the same index is the same
/// pixels whatever was read before. The latest frames are kept, for a step back; what lies before them is
/// decoded anew.
class VideoFrames {
 public:
  /// Goes through the video once, for its frames' stamps.
  /// @param most frames; 0 = all
  /// @param progress told how far that is, from 0 to 1; may be empty
  /// @throws InputError for what no frame can be decoded of
  VideoFrames(std::string path, int most, const std::function<void(double share)>& progress);

  /// s, strictly increasing, by the file's own stamps.
  [[nodiscard]] const std::vector<double>& stamps() const { return stamps_; }
  /// What was mended, one sentence each.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

  /// CV_8UC3 BGR; empty where the frame cannot be decoded. Safe from several threads at once, which wait for
  /// each other.
  [[nodiscard]] cv::Mat image(int index) const;

 private:
  struct Kept {
    int index;
    cv::Mat image;
  };
  /// Makes the stamps increase. @param step s, for a frame without a sensible one @returns how many are told
  int settle(double step);
  void keep(int index, const cv::Mat& image) const;

  std::string path_;
  std::vector<double> stamps_;
  std::vector<std::string> warnings_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<VideoReader> reader_;
  mutable int next_ = 0;  // that the reader gives
  mutable std::deque<Kept> kept_;
};

}  // namespace stillpoint
