#pragma once

#include <string>
#include <vector>

namespace stillpoint {

/// Something the interface said.
struct LogEntry {
  double time_s = 0.0;  ///< the interface's clock, when it was said last
  int frame = -1;       ///< the one shown then; -1 where no sequence was open
  bool error = false;
  std::string text;  ///< one sentence
  int times = 1;     ///< how often it was said
};

/// What was said, oldest first. The same sentence is kept once, with how often and when last.
class EventLog {
 public:
  static constexpr std::size_t kKept = 400;  // lines: memory stays bounded

  void add(LogEntry entry);
  void clear();
  [[nodiscard]] const std::vector<LogEntry>& entries() const { return entries_; }
  [[nodiscard]] int errors() const;  ///< entries that are errors

 private:
  std::vector<LogEntry> entries_;
};

}  // namespace stillpoint
