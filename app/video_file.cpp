#include "app/video_file.hpp"

#include <fmt/format.h>

#include <array>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace stillpoint {
namespace {

struct Format {
  std::string ending;
  std::vector<std::string> codecs;  // the first that there is an encoder for
};

const std::array<Format, 3>& formats() {
  static const std::array<Format, 3> all = {
      {{".mp4", {"avc1", "mp4v"}}, {".mkv", {"X264", "mp4v"}}, {".avi", {"MJPG"}}}};
  return all;
}

const Format* format_of(const std::filesystem::path& path) {
  for (const Format& format : formats())
    if (path.extension() == format.ending) return &format;
  return nullptr;
}

}  // namespace

VideoFile::VideoFile(std::filesystem::path path, double frames_per_second, bool force)
    : path_(std::move(path)),
      file_(path_, path_.extension().string()),
      frames_per_second_(frames_per_second),
      video_(media_module().video()) {
  if (format_of(path_) == nullptr)
    throw InputError(fmt::format("--video {}: a video's name ends in .mp4, .mkv or .avi", path_.string()));
  std::error_code failed;
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  if (!std::filesystem::is_directory(folder, failed))
    throw InputError(fmt::format("--video {}: there is no folder {}", path_.string(), folder.string()));
  if (std::filesystem::exists(path_, failed) && !force)
    throw InputError(fmt::format("--video {}: is there already; --force overwrites it", path_.string()));
}

void VideoFile::begin(const cv::Size& size) {
  for (const std::string& codec : format_of(path_)->codecs) {
    if (video_->open(file_.while_written().string(), codec, frames_per_second_, size)) return;
  }
  throw InputError(fmt::format(
      "--video {}: cannot be written (no permission, or OpenCV has no encoder for it)", path_.string()));
}

void VideoFile::add(const cv::Mat& image) {
  cv::Mat even;
  cv::copyMakeBorder(image, even, 0, image.rows % 2, 0, image.cols % 2, cv::BORDER_REPLICATE);
  if (images_ == 0) begin(even.size());
  video_->write(even);
  ++images_;
}

void VideoFile::finish() {
  video_->close();
  if (media_module().readable_frames(file_.while_written().string(), images_) < images_)
    throw InputError(
        fmt::format("--video {}: could not be written whole (the disk is full?)", path_.string()));
  file_.keep();
}

}  // namespace stillpoint
