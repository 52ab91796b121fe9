// The module itself: the one file that is linked with OpenCV's codecs.
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "core/media/media_module.hpp"

namespace stillpoint {
namespace {

class OpenCvVideo final : public VideoSink {
 public:
  bool open(const std::string& path, const std::string& codec, double frames_per_second,
            const cv::Size& size) override {
    const int tag = cv::VideoWriter::fourcc(codec.at(0), codec.at(1), codec.at(2), codec.at(3));
    return video_.open(path, cv::CAP_FFMPEG, tag, frames_per_second, size);
  }
  void write(const cv::Mat& image) override { video_.write(image); }
  void close() override { video_.release(); }

 private:
  cv::VideoWriter video_;
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
  [[nodiscard]] std::unique_ptr<VideoSink> video() const override { return std::make_unique<OpenCvVideo>(); }
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
