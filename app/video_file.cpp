#include "app/video_file.hpp"

#include <fmt/format.h>

#include <string>

#include "core/error.hpp"

namespace stillpoint {

VideoFile::VideoFile(std::filesystem::path path, const cv::Size& size, double frames_per_second,
                     double usual_step_s, bool force)
    : path_(std::move(path)),
      file_(path_, path_.extension().string()),
      size_(size),
      own_times_(frames_per_second <= 0.0),
      step_s_(own_times_ ? usual_step_s : 1.0 / frames_per_second),
      video_(media_module().video()) {
  const std::string ending = path_.extension().string();
  if (ending != ".mp4" && ending != ".mkv" && ending != ".avi")
    throw InputError(fmt::format("--video {}: a video's name ends in .mp4, .mkv or .avi", path_.string()));
  if (ending != ".avi" && (size.width % 2 != 0 || size.height % 2 != 0))
    throw InputError(fmt::format(
        "--video {}: H.264 takes even sides alone, and the pictures are {}x{}; --size {}x{} makes them "
        "even, and an .avi file takes any",
        path_.string(), size.width, size.height, size.width + size.width % 2, size.height + size.height % 2));
  check_out_file(path_, force);
}

void VideoFile::add(const cv::Mat& image, double timestamp) {
  if (images_ == 0) {
    if (!video_->open(file_.while_written().string(), size_, step_s_))
      throw InputError(
          fmt::format("--video {}: cannot be written (there is no encoder for it)", path_.string()));
  } else {
    const double gap = timestamp - timestamp_;
    shown_at_ += own_times_ && gap > 0.0 ? gap : step_s_;
  }
  timestamp_ = timestamp;
  // What cannot be written is told by finish(), which reads the file back.
  (void)video_->write(image, shown_at_);
  ++images_;
}

void VideoFile::finish() {
  if (!video_->close() || media_module().readable_frames(file_.while_written().string(), images_) < images_)
    throw InputError(
        fmt::format("--video {}: could not be written whole (the disk is full?)", path_.string()));
  file_.keep();
}

}  // namespace stillpoint
