#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

#include "core/media/media_module.hpp"
#include "core/out_folder.hpp"

namespace stillpoint {

/// A video being written, image after image: .mp4 and .mkv (H.264, or MPEG-4 where there is no encoder for
/// it), .avi (Motion JPEG).
class VideoFile {
 public:
  /// Looks at the name alone, so that nobody waits for frames to learn of it.
  /// @throws InputError for an ending it does not know, a folder that there is not, and a file that is there
  /// already while `force` is not set
  VideoFile(std::filesystem::path path, double frames_per_second, bool force);

  /// @param image CV_8UC3 BGR, all of one size; an odd side is repeated to an even one
  /// @throws InputError when the file cannot be begun
  void add(const cv::Mat& image);

  /// Ends the file, reads it back and gives it its name.
  /// @throws InputError when not everything could be written
  void finish();

 private:
  void begin(const cv::Size& size);

  std::filesystem::path path_;
  WholeFile file_;
  double frames_per_second_;
  std::unique_ptr<VideoSink> video_;
  int images_ = 0;
};

}  // namespace stillpoint
