#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

#include "core/media/media_module.hpp"
#include "core/out_folder.hpp"

namespace stillpoint {

/// A video being written, image after image, each at its frame's own time or all at one rate: .mp4 and .mkv
/// (H.264, or MPEG-4 where there is no encoder for it), .avi (Motion JPEG, one rate in any case).
class VideoFile {
 public:
  /// Looks at the name alone, so that nobody waits for frames to learn of it.
  /// @param size px, of all images
  /// @param frames_per_second 0: frames come at their own times
  /// @param usual_step_s s between frames, for what has no times: an .avi file, the last frame
  /// @throws InputError for an ending it does not know, a size that the format cannot hold, a folder that
  /// there is not, and a file that is there already while `force` is not set
  VideoFile(std::filesystem::path path, const cv::Size& size, double frames_per_second, double usual_step_s,
            bool force);

  /// @param image CV_8UC3 BGR of that size
  /// @param timestamp s; one that is not later than the one before follows it at the usual step
  /// @throws InputError when the file cannot be begun
  void add(const cv::Mat& image, double timestamp);

  /// Ends the file, reads it back and gives it its name.
  /// @throws InputError when not everything could be written
  void finish();

 private:
  std::filesystem::path path_;
  WholeFile file_;
  cv::Size size_;
  bool own_times_;
  double step_s_;
  std::unique_ptr<VideoSink> video_;
  int images_ = 0;
  double shown_at_ = 0.0, timestamp_ = 0.0;  // s, of the last image: in the video, of its frame
};

}  // namespace stillpoint
