#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/sequence/image_file.hpp"

namespace stillpoint {

/// How messages are written down.
enum class WireFormat {
  ros1,   ///< ROS 1's serialisation
  cdr,    ///< ROS 2's, little-endian with its four bytes of encapsulation
  other,  ///< one that is not read
};

struct LoggedTopic {
  std::string name;  ///< with its leading slash, as recorded
  std::string type;  ///< `sensor_msgs/Image`, in ROS 1 and 2 alike
  WireFormat format = WireFormat::ros1;
  std::string encoding;               ///< the format's own name, for messages
  std::vector<std::int64_t> times{};  ///< ns, when each message was recorded, not decreasing
};

/// A recording of messages by topic: a ROS 1 bag, an MCAP file, a rosbag2 database. Reading is const and safe
/// from several threads at once.
class MessageLog {
 public:
  static constexpr std::size_t kWhole = std::numeric_limits<std::size_t>::max();

  virtual ~MessageLog() = default;
  [[nodiscard]] virtual const std::string& path() const = 0;
  /// By name.
  [[nodiscard]] virtual const std::vector<LoggedTopic>& topics() const = 0;
  /// A message's bytes, or the first so many of them.
  /// @throws MalformedBytes for one that is not there in whole; InputError where the disk fails
  [[nodiscard]] virtual Bytes read(std::size_t topic, std::size_t message,
                                   std::size_t most = kWhole) const = 0;
  /// What is to be told of the file: that it is cut off, ….
  [[nodiscard]] virtual const std::vector<std::string>& warnings() const = 0;
};

/// "#ROSBAG V2.0".
/// @param file that is read; @param path names it in messages
/// @throws InputError in one sentence for what is none, as all below do
[[nodiscard]] std::unique_ptr<MessageLog> open_ros1_bag(const std::string& file, const std::string& path);
[[nodiscard]] std::unique_ptr<MessageLog> open_mcap(const std::string& file, const std::string& path);
/// rosbag2's SQLite database.
[[nodiscard]] std::unique_ptr<MessageLog> open_rosbag2_db3(const std::string& file, const std::string& path);

}  // namespace stillpoint
