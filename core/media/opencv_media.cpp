// The module itself: the one file that is linked with OpenCV's codecs.
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "core/media/libav_video.hpp"
#include "core/media/media_module.hpp"

namespace stillpoint {
namespace {

class OpenCvVideoReader final : public VideoReader {
 public:
  bool open(const std::string& path) override {
    // FFmpeg writes what it finds amiss to the terminal, unless told otherwise before the first video.
    ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
    return video_.open(path, cv::CAP_FFMPEG);
  }
  bool next() override { return video_.grab(); }
  [[nodiscard]] double seconds() const override {
    // FFmpeg's mark of no stamp comes through as a number: of every frame of a Matroska file of a few frames.
    constexpr double kNoStamp = -1e15;
    const double ms = video_.get(cv::CAP_PROP_POS_MSEC);
    return ms < kNoStamp ? 0.0 : ms / 1000.0;
  }
  cv::Mat image() override {
    cv::Mat image;
    if (!video_.retrieve(image)) return {};
    return image.clone();  // the capture's own buffer is used again
  }
  [[nodiscard]] double frame_rate() const override { return video_.get(cv::CAP_PROP_FPS); }
  [[nodiscard]] int frames_by_head() const override {
    const double count = video_.get(cv::CAP_PROP_FRAME_COUNT);
    return count > 0 && count < 1e9 ? static_cast<int>(count) : 0;
  }

 private:
  cv::VideoCapture video_;
};

class OpenCvMedia final : public MediaModule {
 public:
  [[nodiscard]] cv::Mat decode(const std::vector<unsigned char>& bytes) const override {
    return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  }
  [[nodiscard]] std::vector<unsigned char> encode(const std::string& ending, const cv::Mat& image,
                                                  const std::vector<int>& options) const override {
    std::vector<unsigned char> bytes;
    if (!cv::imencode(ending, image, bytes, options)) bytes.clear();
    return bytes;
  }
  [[nodiscard]] std::unique_ptr<VideoSink> video() const override { return make_libav_video(); }
  [[nodiscard]] std::unique_ptr<VideoReader> video_reader() const override {
    return std::make_unique<OpenCvVideoReader>();
  }
  [[nodiscard]] int readable_frames(const std::string& path, int most) const override {
    cv::VideoCapture written(path, cv::CAP_FFMPEG);
    int readable = 0;
    while (readable < most && written.grab()) ++readable;
    return readable;
  }
};

}  // namespace
}  // namespace stillpoint

extern "C" const stillpoint::MediaModule& stillpoint_media() {
  static const stillpoint::OpenCvMedia media;
  return media;
}
