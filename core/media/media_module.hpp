#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace stillpoint {

// Codecs of images and videos, OpenCV's and FFmpeg's, bring some 240 libraries along, which take longer to
// load than a frame does to process. So they live in a module of their own, loaded when something is to be
// read or written that image_codec.hpp cannot do alone.

/// A video being written: .mp4 and .mkv in H.264 (MPEG-4 where there is no encoder for it), tagged as BT.709
/// of limited range; .avi in Motion JPEG. No frame waits for a later one (no B frames).
class VideoSink {
 public:
  virtual ~VideoSink() = default;
  /// @param path its ending names the container @param size px, even but for .avi
  /// @param step_s s between images: all that .avi knows, elsewhere how long the last is shown
  /// @returns whether there is an encoder, and the file could be begun
  virtual bool open(const std::string& path, const cv::Size& size, double step_s) = 0;
  /// @param image CV_8UC3 BGR @param seconds when it is shown, from 0, later than the one before
  /// @returns whether it could be
  virtual bool write(const cv::Mat& image, double seconds) = 0;
  virtual bool close() = 0;
};

/// A video being read by OpenCV, a frame after another.
class VideoReader {
 public:
  virtual ~VideoReader() = default;
  /// From the first frame on. May be called again.
  /// @returns whether it could be opened
  virtual bool open(const std::string& path) = 0;
  /// Goes to the next frame. @returns false at the end, or where nothing more can be decoded
  virtual bool next() = 0;
  /// When the frame that next() went to is shown, s, by the file's own stamp; 0 where it has none.
  [[nodiscard]] virtual double seconds() const = 0;
  /// The frame that next() went to: CV_8UC3 BGR; empty where it cannot be had.
  virtual cv::Mat image() = 0;
  /// What the file's head says: frames a second, and how many; 0 where it says nothing.
  [[nodiscard]] virtual double frame_rate() const = 0;
  [[nodiscard]] virtual int frames_by_head() const = 0;
};

/// What the module can do.
class MediaModule {
 public:
  virtual ~MediaModule() = default;
  /// cv::imdecode as it is stored (IMREAD_UNCHANGED); empty where it is no image.
  [[nodiscard]] virtual cv::Mat decode(const std::vector<unsigned char>& bytes) const = 0;
  /// cv::imencode. @param ending names the format: ".jpg"
  [[nodiscard]] virtual std::vector<unsigned char> encode(const std::string& ending, const cv::Mat& image,
                                                          const std::vector<int>& options) const = 0;
  [[nodiscard]] virtual std::unique_ptr<VideoSink> video() const = 0;
  [[nodiscard]] virtual std::unique_ptr<VideoReader> video_reader() const = 0;
  /// How many frames of a video can be read, at most `most`.
  [[nodiscard]] virtual int readable_frames(const std::string& path, int most) const = 0;
};

/// The module, loaded at the first call.
/// @throws InputError where it is not beside the program
[[nodiscard]] const MediaModule& media_module();

}  // namespace stillpoint
