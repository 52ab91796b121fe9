#include "ui/shell/event_log.hpp"

#include <algorithm>

namespace stillpoint {

void EventLog::add(LogEntry entry) {
  if (entry.text.empty()) return;
  const auto same = std::find_if(entries_.begin(), entries_.end(), [&](const LogEntry& other) {
    return other.text == entry.text && other.error == entry.error;
  });
  if (same != entries_.end()) {
    entry.times += same->times;
    entries_.erase(same);
  }
  entries_.push_back(std::move(entry));
  if (entries_.size() > kKept) entries_.erase(entries_.begin());
}

void EventLog::clear() { entries_.clear(); }

int EventLog::errors() const {
  return static_cast<int>(
      std::count_if(entries_.begin(), entries_.end(), [](const LogEntry& entry) { return entry.error; }));
}

}  // namespace stillpoint
