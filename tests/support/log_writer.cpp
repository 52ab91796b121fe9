#include "tests/support/log_writer.hpp"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <utility>

namespace stillpoint {
namespace {

template <typename T>
std::string raw(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof(T)};
}

std::string counted(const std::string& bytes) {
  return raw(static_cast<std::uint32_t>(bytes.size())) + bytes;
}

std::string packed(const std::string& compression, const std::string& bytes) {
  if (compression == "none" || compression.empty()) return bytes;
  std::string out;
  if (compression == "bz2") {
    unsigned size = static_cast<unsigned>(bytes.size() + bytes.size() / 100 + 600);
    out.resize(size);
    if (BZ2_bzBuffToBuffCompress(out.data(), &size, const_cast<char*>(bytes.data()),
                                 static_cast<unsigned>(bytes.size()), 9, 0, 0) != BZ_OK)
      throw std::runtime_error("bz2");
    out.resize(size);
  } else if (compression == "lz4") {
    out.resize(LZ4F_compressFrameBound(bytes.size(), nullptr));
    out.resize(LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), nullptr));
  } else {
    out.resize(ZSTD_compressBound(bytes.size()));
    out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1));
  }
  return out;
}

// ROS 1: wiki.ros.org/Bags/Format/2.0

using Fields = std::vector<std::pair<std::string, std::string>>;

std::string fields(const Fields& all) {
  std::string bytes;
  for (const auto& [name, value] : all) bytes += counted(fmt::format("{}={}", name, value));
  return bytes;
}

std::string record(const Fields& header, const std::string& data) {
  return counted(fields(header)) + counted(data);
}

std::string ros_time(std::int64_t ns) {
  return raw(static_cast<std::uint32_t>(ns / 1'000'000'000)) +
         raw(static_cast<std::uint32_t>(ns % 1'000'000'000));
}

std::string op(char code) { return {code}; }

/// Messages that lie in one chunk.
using Span = std::pair<std::size_t, std::size_t>;
std::vector<Span> spans(const std::vector<LogMessage>& messages, std::size_t chunk_bytes) {
  std::vector<Span> all;
  for (std::size_t first = 0, bytes = 0, i = 0; i < messages.size(); ++i) {
    bytes += messages[i].bytes.size();
    if (bytes < chunk_bytes && i + 1 < messages.size()) continue;
    all.emplace_back(first, i + 1);
    first = i + 1, bytes = 0;
  }
  return all;
}

/// Numbers of topics, in the order they first appear.
std::map<std::string, std::uint16_t> numbers_of(const std::vector<LogMessage>& messages) {
  std::map<std::string, std::uint16_t> numbers;
  for (const LogMessage& message : messages)
    numbers.try_emplace(message.topic, static_cast<std::uint16_t>(numbers.size()));
  return numbers;
}

std::string ros2_type(std::string type) { return type.insert(type.find('/'), "/msg"); }

std::string mcap_record(char code, const std::string& bytes) {
  return fmt::format("{}{}{}", op(code), raw(static_cast<std::uint64_t>(bytes.size())), bytes);
}

}  // namespace

void write_ros1_bag(const std::string& path, const std::vector<LogMessage>& messages,
                    const std::string& compression, std::size_t chunk_bytes) {
  std::ofstream file(path, std::ios::binary);
  const std::map<std::string, std::uint16_t> numbers = numbers_of(messages);
  std::map<std::string, std::string> connections;
  const auto id_of = [&](const std::string& topic) { return raw(std::uint32_t{numbers.at(topic)}); };
  const auto header = [&](std::uint64_t index, std::uint32_t chunks) {
    const Fields all = {{"op", op(3)},
                        {"index_pos", raw(index)},
                        {"conn_count", raw(static_cast<std::uint32_t>(numbers.size()))},
                        {"chunk_count", raw(chunks)}};
    return record(all, std::string(4096 - 8 - fields(all).size(), ' '));
  };
  file << "#ROSBAG V2.0\n" << header(0, 0);
  std::string infos;
  std::uint32_t chunks = 0;
  for (const auto& [first, end] : spans(messages, chunk_bytes)) {
    std::string chunk;
    std::map<std::string, std::pair<std::uint32_t, std::string>> index;
    for (std::size_t i = first; i < end; ++i) {
      const LogMessage& message = messages[i];
      if (!connections.contains(message.topic)) {
        connections[message.topic] =
            record({{"op", op(7)}, {"conn", id_of(message.topic)}, {"topic", message.topic}},
                   fields({{"topic", message.topic},
                           {"type", message.type},
                           {"md5sum", std::string(32, '0')},
                           {"message_definition", ""}}));
        chunk += connections[message.topic];
      }
      auto& [count, entries] = index[message.topic];
      ++count;
      entries += ros_time(message.time) + raw(static_cast<std::uint32_t>(chunk.size()));
      chunk += record({{"op", op(2)}, {"conn", id_of(message.topic)}, {"time", ros_time(message.time)}},
                      message.bytes);
    }
    std::string counts;
    const auto position = static_cast<std::uint64_t>(file.tellp());
    file << record({{"op", op(5)},
                    {"compression", compression},
                    {"size", raw(static_cast<std::uint32_t>(chunk.size()))}},
                   packed(compression, chunk));
    for (const auto& [topic, entry] : index) {
      file << record({{"op", op(4)},
                      {"ver", raw(std::uint32_t{1})},
                      {"conn", id_of(topic)},
                      {"count", raw(entry.first)}},
                     entry.second);
      counts += id_of(topic) + raw(entry.first);
    }
    infos += record({{"op", op(6)},
                     {"ver", raw(std::uint32_t{1})},
                     {"chunk_pos", raw(position)},
                     {"start_time", ros_time(messages[first].time)},
                     {"end_time", ros_time(messages[end - 1].time)},
                     {"count", raw(static_cast<std::uint32_t>(index.size()))}},
                    counts);
    ++chunks;
  }
  const auto index_position = static_cast<std::uint64_t>(file.tellp());
  for (const auto& [topic, connection] : connections) file << connection;
  file << infos;
  file.seekp(13);
  file << header(index_position, chunks);
}

void write_mcap(const std::string& path, const std::vector<LogMessage>& messages,
                const std::string& compression, std::size_t chunk_bytes, const std::string& encoding) {
  std::ofstream file(path, std::ios::binary);
  const std::string magic = "\x89MCAP0\r\n";
  file << magic << mcap_record(1, counted("ros2") + counted("test"));
  const std::map<std::string, std::uint16_t> numbers = numbers_of(messages);
  std::map<std::string, std::string> described;
  for (const LogMessage& message : messages) {
    const auto id = static_cast<std::uint16_t>(numbers.at(message.topic) + 1);
    described[message.topic] =
        mcap_record(3, raw(id) + counted(encoding == "cdr" ? ros2_type(message.type) : message.type) +
                           counted("ros2msg") + counted("")) +
        mcap_record(4, raw(id) + raw(id) + counted(message.topic) + counted(encoding) + counted(""));
  }
  const auto message_record = [&](const LogMessage& message) {
    const auto time = raw(static_cast<std::uint64_t>(message.time));
    return mcap_record(5, raw(static_cast<std::uint16_t>(numbers.at(message.topic) + 1)) +
                              raw(std::uint32_t{0}) + time + time + message.bytes);
  };
  if (compression == "unchunked") {
    for (const auto& [topic, bytes] : described) file << bytes;
    for (const LogMessage& message : messages) file << message_record(message);
  } else {
    std::map<std::string, bool> named;
    for (const auto& [first, end] : spans(messages, chunk_bytes)) {
      std::string chunk;
      std::map<std::string, std::string> index;
      for (std::size_t i = first; i < end; ++i) {
        const LogMessage& message = messages[i];
        if (!std::exchange(named[message.topic], true)) chunk += described[message.topic];
        index[message.topic] +=
            raw(static_cast<std::uint64_t>(message.time)) + raw(static_cast<std::uint64_t>(chunk.size()));
        chunk += message_record(message);
      }
      const std::string bytes = packed(compression, chunk);
      file << mcap_record(6, raw(static_cast<std::uint64_t>(messages[first].time)) +
                                 raw(static_cast<std::uint64_t>(messages[end - 1].time)) +
                                 raw(static_cast<std::uint64_t>(chunk.size())) + raw(std::uint32_t{0}) +
                                 counted(compression) + raw(static_cast<std::uint64_t>(bytes.size())) +
                                 bytes);
      for (const auto& [topic, entries] : index)
        file << mcap_record(7, raw(static_cast<std::uint16_t>(numbers.at(topic) + 1)) + counted(entries));
    }
  }
  file << mcap_record(15, raw(std::uint32_t{0}));
  for (const auto& [topic, bytes] : described) file << bytes;
  file << mcap_record(2, raw(std::uint64_t{0}) + raw(std::uint64_t{0}) + raw(std::uint32_t{0})) << magic;
}

void write_db3(const std::string& path, const std::vector<LogMessage>& messages) {
  sqlite3* database = nullptr;
  const auto check = [&](int state) {
    if (state != SQLITE_OK && state != SQLITE_DONE) throw std::runtime_error(sqlite3_errmsg(database));
  };
  check(sqlite3_open(path.c_str(), &database));
  check(sqlite3_exec(database,
                     "PRAGMA synchronous=OFF; BEGIN;"
                     "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
                     " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
                     "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,"
                     " timestamp INTEGER NOT NULL, data BLOB NOT NULL);",
                     nullptr, nullptr, nullptr));
  const std::map<std::string, std::uint16_t> numbers = numbers_of(messages);
  std::map<std::string, bool> named;
  sqlite3_stmt *topic = nullptr, *row = nullptr;
  check(sqlite3_prepare_v2(database, "INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')", -1, &topic, nullptr));
  check(sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", -1,
                           &row, nullptr));
  for (const LogMessage& message : messages) {
    const int id = numbers.at(message.topic) + 1;
    if (!std::exchange(named[message.topic], true)) {
      const std::string type = ros2_type(message.type);
      sqlite3_reset(topic);
      sqlite3_bind_int(topic, 1, id);
      sqlite3_bind_text(topic, 2, message.topic.c_str(), -1, SQLITE_TRANSIENT);
      sqlite3_bind_text(topic, 3, type.c_str(), -1, SQLITE_TRANSIENT);
      check(sqlite3_step(topic));
    }
    sqlite3_reset(row);
    sqlite3_bind_int(row, 1, id);
    sqlite3_bind_int64(row, 2, message.time);
    sqlite3_bind_blob(row, 3, message.bytes.data(), static_cast<int>(message.bytes.size()), SQLITE_STATIC);
    check(sqlite3_step(row));
  }
  sqlite3_finalize(topic), sqlite3_finalize(row);
  check(sqlite3_exec(database, "CREATE INDEX timestamp_idx ON messages (timestamp ASC); COMMIT;", nullptr,
                     nullptr, nullptr));
  sqlite3_close(database);
}

}  // namespace stillpoint
