#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/se3.hpp"
#include "core/sequence/bag/byte_reader.hpp"
#include "core/sequence/bag/message_log.hpp"
#include "core/sequence/image_file.hpp"

namespace stillpoint {

// The messages that are read, in ROS 1's serialisation and in ROS 2's CDR. Every function throws
// MalformedBytes for bytes that hold no such message.

struct MessageHeader {
  std::int64_t stamp = 0;  ///< ns since 1970, or since whenever the clock of the recording began
  std::string frame;       ///< without its leading slash
};

/// So many bytes of a message hold its header's stamp.
inline constexpr std::size_t kStampBytes = 16;

/// The stamp of a message that begins with a header, of which kStampBytes are enough.
[[nodiscard]] std::int64_t stamp_of(ByteView message, WireFormat format);

/// An image that is wider or higher is taken for a damaged message.
inline constexpr std::uint32_t kLargestImageSide = 16384;  // px

/// Messages at a topic's beginning that are looked at for one that tells what the topic holds: drivers begin
/// with a few empty ones, and a topic that holds nothing else need not be read to its end.
inline constexpr std::size_t kFirstMessages = 100;

/// A ROS 2 type such as `sensor_msgs/msg/Image` as ROS 1 has it.
[[nodiscard]] std::string plain_type(std::string type);

/// What a sensor_msgs/Image or CompressedImage says of itself before its pixels.
struct ImageMessage {
  MessageHeader header;
  bool is_compressed = false;
  std::uint32_t width = 0, height = 0, step = 0;  ///< px and bytes; 0 where it is compressed
  bool is_bigendian = false;
  std::string encoding;  ///< `rgb8`, …; of a compressed one its format, `rgb8; jpeg compressed bgr8`
  ByteView data;

  /// 16UC1, mono16, 32FC1, or a depth image compressed as such.
  [[nodiscard]] bool may_be_depth() const;
  /// Whether its depth is floating point, in metres.
  [[nodiscard]] bool is_float() const;
};

/// @param whole false for a message's beginning, whose data are not looked at
[[nodiscard]] ImageMessage image_message(ByteView message, WireFormat format, bool is_compressed,
                                         bool whole = true);

/// Bytes of an image message that hold all but its data, with names of usual length.
inline constexpr std::size_t kImageHeadBytes = 1024;

struct CameraInfoMessage {
  MessageHeader header;
  std::uint32_t width = 0, height = 0;
  std::string model;                           ///< of distortion
  std::vector<double> distortion;              ///< D
  std::array<double, 9> k{};                   ///< of the image as it is
  std::array<double, 12> p{};                  ///< of the rectified image
  std::uint32_t binning_x = 0, binning_y = 0;  ///< pixels that became one; 0 means 1
  /// What of the whole image is sent, px of it, before binning; all 0 means the whole.
  std::uint32_t roi_x = 0, roi_y = 0, roi_width = 0, roi_height = 0;
};
[[nodiscard]] CameraInfoMessage camera_info_message(ByteView message, WireFormat format);

/// A pose of one frame in another, as tf, PoseStamped, TransformStamped and Odometry have it.
struct TransformMessage {
  std::int64_t stamp = 0;  ///< ns
  std::string parent;      ///< without leading slash
  std::string child;       ///< likewise; empty where the message does not say (PoseStamped)
  Pose parent_from_child = Pose::Identity();
  bool is_pose = true;  ///< false for a quaternion that is no rotation, and for NaN
};
/// @param type `tf/tfMessage`, `tf2_msgs/TFMessage`, `geometry_msgs/PoseStamped`, `…/TransformStamped`,
/// `…/PoseWithCovarianceStamped` or `nav_msgs/Odometry`
[[nodiscard]] std::vector<TransformMessage> transform_messages(ByteView message, WireFormat format,
                                                               std::string_view type);
/// Whether transform_messages reads messages of that type: many poses each, or one.
[[nodiscard]] bool is_tf_type(std::string_view type);
[[nodiscard]] bool is_pose_type(std::string_view type);

/// std_msgs/Float32, which begins with no header.
[[nodiscard]] float float_message(ByteView message, WireFormat format);

}  // namespace stillpoint
