#pragma once

#include <list>

#include "core/sequence/source.hpp"

namespace stillpoint {

/// The frames read last: going a step back, or looking at a pair again, need not read anew.
class FrameCache {
 public:
  explicit FrameCache(const FrameSource& source, std::size_t capacity = 16)
      : source_(&source), capacity_(capacity) {}

  /// A frame. Its images are shared with the cache: they are to be read only.
  [[nodiscard]] Frame read(int index) {
    for (auto it = frames_.begin(); it != frames_.end(); ++it) {
      if (it->index != index) continue;
      frames_.splice(frames_.begin(), frames_, it);
      return frames_.front();
    }
    frames_.push_front(source_->read(index));
    frames_.front().index = index;
    if (frames_.size() > capacity_) frames_.pop_back();
    return frames_.front();
  }

 private:
  const FrameSource* source_;
  std::size_t capacity_;
  std::list<Frame> frames_;  // used last first
};

}  // namespace stillpoint
