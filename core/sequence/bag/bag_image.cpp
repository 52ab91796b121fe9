#include "core/sequence/bag/bag_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace stillpoint {
namespace {

/// How an encoding of sensor_msgs is stored, and what OpenCV makes BGR of it; -1 = nothing needs be done.
struct Encoding {
  const char* name;
  int type;
  int conversion;
};

// OpenCV names Bayer patterns by the second row's second and third pixel, ROS by the first row's first two.
constexpr Encoding kEncodings[] = {{"rgb8", CV_8UC3, cv::COLOR_RGB2BGR},
                                   {"bgr8", CV_8UC3, -1},
                                   {"8UC3", CV_8UC3, -1},
                                   {"rgba8", CV_8UC4, cv::COLOR_RGBA2BGR},
                                   {"bgra8", CV_8UC4, cv::COLOR_BGRA2BGR},
                                   {"8UC4", CV_8UC4, cv::COLOR_BGRA2BGR},
                                   {"mono8", CV_8UC1, -1},
                                   {"8UC1", CV_8UC1, -1},
                                   {"mono16", CV_16UC1, -1},
                                   {"16UC1", CV_16UC1, -1},
                                   {"32FC1", CV_32FC1, -1},
                                   {"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2BGR},
                                   {"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2BGR},
                                   {"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2BGR},
                                   {"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2BGR},
                                   {"yuv422", CV_8UC2, cv::COLOR_YUV2BGR_UYVY},
                                   {"uyvy", CV_8UC2, cv::COLOR_YUV2BGR_UYVY},
                                   {"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2BGR_YUY2},
                                   {"yuyv", CV_8UC2, cv::COLOR_YUV2BGR_YUY2}};

void only_measurements(cv::Mat& metres) {
  for (int y = 0; y < metres.rows; ++y) {
    auto* row = metres.ptr<float>(y);
    for (int x = 0; x < metres.cols; ++x) row[x] = std::isfinite(row[x]) && row[x] > 0 ? row[x] : 0.0F;
  }
}

void swap_bytes(cv::Mat& image) {
  const std::size_t size = image.elemSize1();
  for (int y = 0; y < image.rows; ++y) {
    unsigned char* row = image.ptr(y);
    const std::size_t end = static_cast<std::size_t>(image.cols) * image.elemSize();
    for (std::size_t at = 0; at < end; at += size) std::reverse(row + at, row + at + size);
  }
}

ImageRead raw_image(const ImageMessage& message, const std::string& path) {
  ImageRead read;
  const auto* known =
      std::find_if(std::begin(kEncodings), std::end(kEncodings),
                   [&](const Encoding& encoding) { return encoding.name == message.encoding; });
  if (known == std::end(kEncodings)) {
    read.problem =
        fmt::format("{} has the encoding '{}', which is not read", path, message.encoding.substr(0, 40));
    read.is_other_format = true;
    return read;
  }
  const std::uint64_t row =
      std::uint64_t{message.width} * static_cast<std::uint64_t>(CV_ELEM_SIZE(known->type));
  if (message.width == 0 || message.height == 0 || message.width > kLargestImageSide ||
      message.height > kLargestImageSide)
    read.problem = fmt::format("{} claims a size of {}x{} px, expected 1 to {} px a side", path,
                               message.width, message.height, kLargestImageSide);
  else if (message.step < row)
    read.problem = fmt::format("{} is damaged: {} bytes a row for {} px of {}", path, message.step,
                               message.width, message.encoding);
  else if (message.data.size() < std::uint64_t{message.step} * (message.height - 1) + row)
    read.problem = fmt::format("{} is truncated", path);
  if (!read.problem.empty()) return read;
  // Nothing writes into the message through this.
  const cv::Mat stored(static_cast<int>(message.height), static_cast<int>(message.width), known->type,
                       const_cast<unsigned char*>(message.data.data()), message.step);
  if (known->conversion >= 0)
    cv::cvtColor(stored, read.image, known->conversion);
  else
    read.image = stored.clone();
  if (message.is_bigendian && read.image.elemSize1() > 1) swap_bytes(read.image);
  return read;
}

/// compressed_depth_image_transport: twelve bytes (a format, and two parameters of inverse depth), then a
/// PNG.
ImageRead compressed_depth(const ImageMessage& message, const std::string& path) {
  constexpr std::size_t kHead = 12;  // bytes: an int32 and two floats
  ImageRead read;
  if (message.encoding.find("rvl") != std::string::npos) {
    read.problem = fmt::format("{} is depth compressed by RVL, which is not read", path);
    read.is_other_format = true;
    return read;
  }
  if (message.data.size() <= kHead) {
    read.problem = fmt::format("{} is truncated", path);
    return read;
  }
  ByteReader head(message.data);
  head.take(4);
  const auto a = head.number<float>(), b = head.number<float>();
  read = decode_image(path, Bytes(message.data.begin() + kHead, message.data.end()));
  if (read.image.empty() || !message.is_float()) return read;
  if (read.image.type() != CV_16UC1) {
    read.problem = fmt::format("{} is no depth of 16 bits", path);
    read.image.release();
    return read;
  }
  cv::Mat metres(read.image.size(), CV_32FC1);
  for (int y = 0; y < metres.rows; ++y)
    for (int x = 0; x < metres.cols; ++x) {
      const auto stored = read.image.at<std::uint16_t>(y, x);
      metres.at<float>(y, x) = stored == 0 ? 0.0F : a / (static_cast<float>(stored) - b);
    }
  read.image = metres;
  return read;
}

}  // namespace

ImageRead image_of(const ImageMessage& message, const std::string& path) {
  ImageRead read;
  if (!message.is_compressed)
    read = raw_image(message, path);
  else if (message.encoding.find("compressedDepth") != std::string::npos)
    read = compressed_depth(message, path);
  else
    read = decode_image(path, Bytes(message.data.begin(), message.data.end()));
  if (read.image.type() == CV_32FC1 && !read.image.empty()) {
    only_measurements(read.image);
    read.in_metres = true;
  }
  return read;
}

}  // namespace stillpoint
