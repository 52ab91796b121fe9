#include "core/sequence/prefetch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>

namespace stillpoint {

Prefetcher::Prefetcher(const FrameSource& source, int first, int end, int workers, int window)
    : source_(source),
      end_(end < 0 ? source.size() : std::min(end, source.size())),
      window_(std::max(window, 1)),
      next_(std::max(first, 0)),
      to_read_(next_) {
  const int useful = std::clamp(workers, 1, window_);
  for (int i = 0; i < useful && i < end_ - next_; ++i) workers_.emplace_back([this] { work(); });
}

Prefetcher::~Prefetcher() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  room_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void Prefetcher::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    room_.wait(lock, [this] { return stopping_ || to_read_ >= end_ || to_read_ < next_ + window_; });
    if (stopping_ || to_read_ >= end_) return;
    const int index = to_read_++;
    lock.unlock();
    Frame frame = read_safely(index);
    lock.lock();
    ready_.emplace(index, std::move(frame));
    arrived_.notify_all();
  }
}

Frame Prefetcher::read_safely(int index) const {
  Frame unreadable;
  unreadable.index = index;
  try {
    return source_.read(index);
  } catch (const std::exception& error) {
    unreadable.problem = fmt::format("frame {} cannot be read: {}", index, error.what());
  }
  return unreadable;
}

Frame Prefetcher::next() {
  std::unique_lock lock(mutex_);
  if (next_ >= end_) {
    Frame past_end;
    past_end.index = next_;
    past_end.problem = "there is no frame behind the sequence's end";
    return past_end;
  }
  arrived_.wait(lock, [this] { return ready_.contains(next_); });
  Frame frame = std::move(ready_.extract(next_).mapped());
  ++next_;
  lock.unlock();
  room_.notify_all();
  return frame;
}

}  // namespace stillpoint
