#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/inspect/export_session.hpp"
#include "ui/session/debug_view.hpp"

namespace stillpoint {

/// Something being written on a thread of its own, while the session goes on.
class ExportJob {
 public:
  /// @param work writes; returns what it wrote in a sentence, or throws why it could not
  using Work = std::function<std::string(const ExportControl&)>;

  /// @param on_news called from the job's thread, ten times a second at most, and when it has ended
  ExportJob(std::string folder, Work work, std::function<void()> on_news);
  /// Stops it, and waits until what it wrote is taken away.
  ~ExportJob();
  ExportJob(const ExportJob&) = delete;
  ExportJob& operator=(const ExportJob&) = delete;

  void stop() { stop_ = true; }

  /// How far it is; nothing once it has ended.
  [[nodiscard]] std::optional<ExportView> view() const;

  struct Outcome {
    std::string told;
    bool failed = false;
  };
  /// How it ended; nothing while it goes on.
  [[nodiscard]] std::optional<Outcome> outcome() const;

 private:
  void run(const Work& work);
  void tell(const char* what, int done, int total);

  std::function<void()> on_news_;
  std::atomic<bool> stop_ = false;
  mutable std::mutex mutex_;  // guards what follows
  ExportView view_;
  std::optional<Outcome> outcome_;
  std::jthread thread_;  // last: it ends before what it works with
};

}  // namespace stillpoint
