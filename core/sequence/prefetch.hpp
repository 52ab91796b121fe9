#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "core/sequence/source.hpp"

namespace stillpoint {

/// Reads frames ahead of their use on worker threads and hands them out in order. Frames are the same
/// whatever the number of workers; only when they are ready differs.
class Prefetcher {
 public:
  /// Reads frames `first` to `end` - 1 of `source`, which must outlive the prefetcher; end = -1 means its
  /// size.
  /// @param workers threads that read, at least 1
  /// @param window frames held ready or being read at once, at least 1: what bounds the memory used
  explicit Prefetcher(const FrameSource& source, int first = 0, int end = -1, int workers = 1,
                      int window = 4);

  /// Stops the workers after the frames they are reading; waits for them.
  ~Prefetcher();
  Prefetcher(const Prefetcher&) = delete;
  Prefetcher& operator=(const Prefetcher&) = delete;

  /// False once every frame was handed out.
  [[nodiscard]] bool has_next() const { return next_ < end_; }

  /// The next frame, waiting for it if need be. Never throws: past the end, and where a source throws against
  /// its contract, it gives an unreadable frame that says so.
  [[nodiscard]] Frame next();

 private:
  void work();
  [[nodiscard]] Frame read_safely(int index) const;

  const FrameSource& source_;
  const int end_, window_;
  int next_;     ///< index next() hands out next
  int to_read_;  ///< index a worker reads next
  bool stopping_ = false;
  std::map<int, Frame> ready_;
  std::mutex mutex_;  ///< guards next_, to_read_, stopping_ and ready_
  std::condition_variable room_, arrived_;
  std::vector<std::thread> workers_;
};

}  // namespace stillpoint
