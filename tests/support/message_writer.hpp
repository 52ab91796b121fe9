#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/se3.hpp"

namespace stillpoint {

/// ROS messages as bytes, for tests: ROS 1's serialisation, or ROS 2's CDR with its four bytes of
/// encapsulation.
class MessageWriter {
 public:
  explicit MessageWriter(bool cdr) : cdr_(cdr) {
    if (cdr_) bytes_ = std::string("\0\1\0\0", 4);
  }

  template <typename T>
  MessageWriter& number(T value) {
    if (cdr_)
      while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_ += '\0';
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    return *this;
  }
  MessageWriter& text(std::string_view value);
  MessageWriter& bytes(std::string_view value);
  MessageWriter& header(std::int64_t stamp_ns, std::string_view frame);
  MessageWriter& pose(const Pose& pose);

  [[nodiscard]] const std::string& take() const { return bytes_; }

 private:
  bool cdr_;
  std::string bytes_;
};

/// sensor_msgs/Image. @param encoding as stored; the pixels are taken as they are
[[nodiscard]] std::string image_bytes(bool cdr, std::int64_t stamp, std::string_view frame,
                                      std::string_view encoding, const cv::Mat& pixels);
/// sensor_msgs/CompressedImage.
[[nodiscard]] std::string compressed_bytes(bool cdr, std::int64_t stamp, std::string_view frame,
                                           std::string_view format, std::string_view data);

struct InfoExample {
  std::uint32_t width = 640, height = 480;
  std::string model = "plumb_bob";
  std::vector<double> d;
  double fx = 525, fy = 525, cx = 319.5, cy = 239.5;
  std::string frame = "camera";
  std::uint32_t binning = 0;           ///< along both sides
  std::array<std::uint32_t, 4> roi{};  ///< x, y, width, height
};
/// sensor_msgs/CameraInfo, whose P is of half its focal length.
[[nodiscard]] std::string info_bytes(bool cdr, std::int64_t stamp, const InfoExample& info);

struct TransformExample {
  std::int64_t stamp = 0;
  std::string parent, child;
  Pose pose = Pose::Identity();
};
/// tf2_msgs/TFMessage.
[[nodiscard]] std::string tf_bytes(bool cdr, const std::vector<TransformExample>& transforms);
/// geometry_msgs/PoseStamped.
[[nodiscard]] std::string pose_bytes(bool cdr, std::int64_t stamp, std::string_view frame, const Pose& pose);

}  // namespace stillpoint
