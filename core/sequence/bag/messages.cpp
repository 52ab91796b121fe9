#include "core/sequence/bag/messages.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr std::size_t kLeastTransform = 60;    // bytes of one in a message of many
constexpr std::uint32_t kMostDistortion = 64;  // coefficients: far more than any model has
constexpr double kLengthTolerance = 0.01;      // as trajectory files have it

/// Values of a message one after another.
class MessageReader {
 public:
  MessageReader(ByteView message, WireFormat format) : reader_(message), is_cdr_(format == WireFormat::cdr) {
    if (format == WireFormat::other) throw MalformedBytes("is written in a way that is not read");
    if (!is_cdr_) return;
    // OMG's DDS-XTypes, 7.6.2: two bytes say how, two are options.
    const ByteView head = reader_.take(4);
    if (head[0] != 0 || head[1] != 1)
      throw MalformedBytes("is not in plain little-endian CDR, which is what is read");
  }

  template <typename T>
  T number() {
    align(sizeof(T));
    return reader_.number<T>();
  }
  std::string text() {
    std::string value = ByteReader::to_text(reader_.take(number<std::uint32_t>()));
    if (is_cdr_ && !value.empty() && value.back() == '\0') value.pop_back();
    return printable(std::move(value));
  }
  std::int64_t stamp() {
    // ROS 1 counts seconds without a sign.
    const std::int64_t seconds =
        is_cdr_ ? std::int64_t{number<std::int32_t>()} : std::int64_t{number<std::uint32_t>()};
    return seconds * 1'000'000'000 + number<std::uint32_t>();
  }
  void begin_header() {
    if (!is_cdr_) number<std::uint32_t>();  // the sequence number
  }
  MessageHeader header() {
    begin_header();
    MessageHeader header;
    header.stamp = stamp();
    header.frame = frame();
    return header;
  }
  std::string frame() {
    std::string name = text();
    if (name.starts_with('/')) name.erase(0, 1);
    return name;
  }
  /// Position or translation, then a quaternion with its real part last.
  void pose(TransformMessage& message) {
    double n[7];
    for (double& value : n) value = number<double>();
    const Eigen::Quaterniond q(n[6], n[3], n[4], n[5]);
    message.is_pose = std::all_of(std::begin(n), std::end(n), [](double v) { return std::isfinite(v); }) &&
                      std::abs(q.norm() - 1.0) < kLengthTolerance;
    if (!message.is_pose) return;
    message.parent_from_child.linear() = q.normalized().toRotationMatrix();
    message.parent_from_child.translation() = Eigen::Vector3d(n[0], n[1], n[2]);
  }
  ByteView counted() { return reader_.take(number<std::uint32_t>()); }
  [[nodiscard]] std::size_t left() const { return reader_.left(); }

 private:
  /// CDR's values stand at multiples of their size, counted from behind its first four bytes.
  void align(std::size_t size) {
    if (!is_cdr_) return;
    const std::size_t beyond = (reader_.at() - 4) % size;
    if (beyond != 0) reader_.take(size - beyond);
  }

  ByteReader reader_;
  bool is_cdr_;
};

bool contains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

}  // namespace

std::string plain_type(std::string type) {
  if (const auto at = type.find("/msg/"); at != std::string::npos) type.erase(at, 4);
  return type;
}

std::int64_t stamp_of(ByteView message, WireFormat format) {
  MessageReader reader(message, format);
  reader.begin_header();
  return reader.stamp();
}

bool ImageMessage::may_be_depth() const {
  if (is_compressed) return contains(encoding, "compressedDepth") || encoding.starts_with("16UC1");
  return encoding == "16UC1" || encoding == "mono16" || encoding == "32FC1";
}

bool ImageMessage::is_float() const { return encoding.starts_with("32FC1"); }

ImageMessage image_message(ByteView message, WireFormat format, bool is_compressed, bool whole) {
  MessageReader reader(message, format);
  ImageMessage image;
  image.is_compressed = is_compressed;
  image.header = reader.header();
  if (!is_compressed)
    image.height = reader.number<std::uint32_t>(), image.width = reader.number<std::uint32_t>();
  image.encoding = reader.text();
  if (!is_compressed) {
    image.is_bigendian = reader.number<std::uint8_t>() != 0;
    image.step = reader.number<std::uint32_t>();
  }
  if (whole) image.data = reader.counted();
  return image;
}

CameraInfoMessage camera_info_message(ByteView message, WireFormat format) {
  MessageReader reader(message, format);
  CameraInfoMessage info;
  info.header = reader.header();
  info.height = reader.number<std::uint32_t>(), info.width = reader.number<std::uint32_t>();
  info.model = reader.text();
  const auto count = reader.number<std::uint32_t>();
  if (count > kMostDistortion) throw MalformedBytes("claims too many distortion coefficients");
  for (std::uint32_t i = 0; i < count; ++i) info.distortion.push_back(reader.number<double>());
  for (double& value : info.k) value = reader.number<double>();
  for (int i = 0; i < 9; ++i) reader.number<double>();  // R
  for (double& value : info.p) value = reader.number<double>();
  for (std::uint32_t* value :
       {&info.binning_x, &info.binning_y, &info.roi_x, &info.roi_y, &info.roi_height, &info.roi_width})
    *value = reader.number<std::uint32_t>();
  return info;
}

bool is_tf_type(std::string_view type) { return type == "tf/tfMessage" || type == "tf2_msgs/TFMessage"; }

bool is_pose_type(std::string_view type) {
  return type == "geometry_msgs/PoseStamped" || type == "geometry_msgs/TransformStamped" ||
         type == "geometry_msgs/PoseWithCovarianceStamped" || type == "nav_msgs/Odometry";
}

std::vector<TransformMessage> transform_messages(ByteView message, WireFormat format, std::string_view type) {
  MessageReader reader(message, format);
  std::vector<TransformMessage> transforms;
  std::uint32_t count = 1;
  if (is_tf_type(type)) {
    count = reader.number<std::uint32_t>();
    if (count > reader.left() / kLeastTransform) throw MalformedBytes("claims more transforms than it holds");
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    TransformMessage transform;
    const MessageHeader header = reader.header();
    transform.stamp = header.stamp;
    transform.parent = header.frame;
    if (is_tf_type(type) || type == "geometry_msgs/TransformStamped" || type == "nav_msgs/Odometry")
      transform.child = reader.frame();
    reader.pose(transform);
    transforms.push_back(std::move(transform));
  }
  return transforms;
}

float float_message(ByteView message, WireFormat format) {
  return MessageReader(message, format).number<float>();
}

}  // namespace stillpoint
