#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "core/error.hpp"
#include "core/sequence/bag/byte_reader.hpp"
#include "core/sequence/bag/decompress.hpp"
#include "core/sequence/bag/message_log.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

// The format: rosbag2_storage_sqlite3, tables topics(id, name, type, serialization_format, …) and
// messages(id, topic_id, timestamp, data).

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct CloseStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, CloseStatement>;

/// A path as SQLite's URIs have it.
std::string uri_of(const std::string& path, bool immutable) {
  std::string uri = "file:";
  for (const char c : path) {
    if (c == '%' || c == '?' || c == '#')
      uri += fmt::format("%{:02x}", static_cast<unsigned>(c));
    else
      uri += c;
  }
  return uri + (immutable ? "?mode=ro&immutable=1" : "?mode=ro");
}

class Database final : public MessageLog {
 public:
  Database(std::string file, const std::string& path) : path_(path), file_(std::move(file)) {
    open();
    refuse_views();
    read_topics();
    read_places();
  }

  [[nodiscard]] const std::string& path() const override { return path_; }
  [[nodiscard]] const std::vector<LoggedTopic>& topics() const override { return topics_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }

  [[nodiscard]] Bytes read(std::size_t topic, std::size_t message, std::size_t most) const override {
    const sqlite3_int64 row = rows_.at(topic).at(message);
    const std::lock_guard lock(mutex_);
    sqlite3_blob* opened = nullptr;
    const int state = sqlite3_blob_open(database_.get(), "main", "messages", "data", row, 0, &opened);
    const std::unique_ptr<sqlite3_blob, int (*)(sqlite3_blob*)> blob(opened, sqlite3_blob_close);
    if (state != SQLITE_OK) throw MalformedBytes("is damaged");
    const int size = sqlite3_blob_bytes(blob.get());
    Bytes bytes(std::min(most, static_cast<std::size_t>(size)));
    if (sqlite3_blob_read(blob.get(), bytes.data(), static_cast<int>(bytes.size()), 0) != SQLITE_OK)
      throw MalformedBytes("is truncated");
    return bytes;
  }

 private:
  [[nodiscard]] bool try_open(bool immutable) {
    sqlite3* opened = nullptr;
    const int state =
        sqlite3_open_v2(uri_of(file_, immutable).c_str(), &opened,
                        SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_FULLMUTEX, nullptr);
    database_.reset(opened);
    if (state != SQLITE_OK) return false;
    // A value that claims to be larger is a damaged one.
    sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, static_cast<int>(kLargestChunk));
    if (can_be_asked()) return true;
    // SQLite refuses a file that is shorter than its head says, unless the schema is open to repair.
    if (sqlite3_exec(opened, "PRAGMA writable_schema=ON", nullptr, nullptr, nullptr) != SQLITE_OK)
      return false;
    is_cut_ = can_be_asked();
    return is_cut_;
  }

  [[nodiscard]] bool can_be_asked() const {
    return sqlite3_exec(database_.get(), "SELECT count(*) FROM sqlite_master", nullptr, nullptr, nullptr) ==
           SQLITE_OK;
  }

  void open() {
    // What was left open while it was written needs a file beside it, which a read-only disk does not take.
    if (!try_open(false) && !try_open(true))
      throw InputError(fmt::format("{}: is no SQLite database that can be read: {}", path_, fault()));
  }

  [[nodiscard]] std::string fault() const { return sqlite3_errmsg(database_.get()); }

  [[nodiscard]] Statement statement(const char* query) const {
    sqlite3_stmt* prepared = nullptr;
    if (sqlite3_prepare_v2(database_.get(), query, -1, &prepared, nullptr) != SQLITE_OK)
      throw InputError(fmt::format("{}: is no rosbag2 database: {}", path_, fault()));
    return Statement(prepared);
  }

  [[nodiscard]] static std::string text(sqlite3_stmt* row, int column) {
    const auto* value = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
    return value == nullptr ? std::string() : printable(value);
  }

  /// A view is a query of whoever made the file, and need never end.
  void refuse_views() const {
    const Statement views =
        statement("SELECT 1 FROM sqlite_master WHERE type = 'view' AND name IN ('topics', 'messages')");
    if (sqlite3_step(views.get()) == SQLITE_ROW)
      throw InputError(
          fmt::format("{}: is no rosbag2 database: topics and messages are tables there", path_));
  }

  void read_topics() {
    const Statement rows = statement("SELECT id, name, type, serialization_format FROM topics ORDER BY name");
    while (sqlite3_step(rows.get()) == SQLITE_ROW) {
      const std::string encoding = text(rows.get(), 3);
      by_id_[sqlite3_column_int64(rows.get(), 0)] = topics_.size();
      topics_.push_back({text(rows.get(), 1), plain_type(text(rows.get(), 2)),
                         encoding == "cdr" ? WireFormat::cdr : WireFormat::other, encoding});
    }
    rows_.resize(topics_.size());
  }

  /// In the order they were written in, which needs no index: that stands at the end of a file that may be
  /// cut.
  void read_places() {
    const Statement rows = statement("SELECT id, topic_id, timestamp FROM messages");
    std::vector<std::vector<std::pair<std::int64_t, sqlite3_int64>>> places(topics_.size());
    int state = SQLITE_OK;
    std::size_t count = 0;
    while ((state = sqlite3_step(rows.get())) == SQLITE_ROW) {
      const auto topic = by_id_.find(sqlite3_column_int64(rows.get(), 1));
      if (topic == by_id_.end()) continue;
      places[topic->second].push_back(
          {sqlite3_column_int64(rows.get(), 2), sqlite3_column_int64(rows.get(), 0)});
      ++count;
    }
    if (is_cut_ || state != SQLITE_DONE)
      warnings_.push_back(fmt::format("{}: is {}; the {} messages it still lists were read", path_,
                                      is_cut_ ? "cut off" : "damaged (" + fault() + ")", count));
    for (std::size_t i = 0; i < places.size(); ++i) {
      std::stable_sort(places[i].begin(), places[i].end(),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
      for (const auto& [time, row] : places[i]) topics_[i].times.push_back(time), rows_[i].push_back(row);
    }
  }

  std::string path_, file_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  bool is_cut_ = false;
  std::map<sqlite3_int64, std::size_t> by_id_;
  std::vector<LoggedTopic> topics_;
  std::vector<std::vector<sqlite3_int64>> rows_;
  std::vector<std::string> warnings_;
  mutable std::mutex mutex_;  ///< a connection is used by one thread at a time
};

}  // namespace

std::unique_ptr<MessageLog> open_rosbag2_db3(const std::string& file, const std::string& path) {
  return std::make_unique<Database>(file, path);
}

}  // namespace stillpoint
