#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace stillpoint {

/// One message to be written.
struct LogMessage {
  std::string topic, type;  ///< the type as ROS 1 has it
  std::int64_t time = 0;    ///< ns
  std::string bytes;
};

/// Writes recordings for tests, as small as the formats allow, by nothing but the formats' own pages: none of
/// the readers' code is used.
///
/// @param chunk_bytes a chunk is closed when it holds so many
/// @param compression none, bz2 or lz4
void write_ros1_bag(const std::string& path, const std::vector<LogMessage>& messages,
                    const std::string& compression = "none", std::size_t chunk_bytes = 768 << 10);
/// @param compression "" (chunks as they are), lz4, zstd, or "unchunked"
void write_mcap(const std::string& path, const std::vector<LogMessage>& messages,
                const std::string& compression = "", std::size_t chunk_bytes = 768 << 10,
                const std::string& encoding = "cdr");
/// rosbag2's database.
void write_db3(const std::string& path, const std::vector<LogMessage>& messages);

}  // namespace stillpoint
