#pragma once

#include <algorithm>
#include <future>
#include <list>
#include <set>
#include <vector>

#include "core/sequence/source.hpp"

namespace stillpoint {

/// What a method commonly compares a frame with lies no farther back; each takes 2.5 MB.
inline constexpr std::size_t kFramesKept = 12;

/// The frames read last: going a step back, or looking at a pair again, need not read anew.
class FrameCache {
 public:
  explicit FrameCache(const FrameSource& source, std::size_t capacity = kFramesKept)
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

  /// The same, while the frame after it is already being read beside: for who takes one after the other.
  [[nodiscard]] Frame read_in_turn(int index) {
    if (coming_.valid()) {
      Frame come = coming_.get();
      come.index = coming_index_;
      if (!holds(coming_index_)) keep(std::move(come));
    }
    Frame frame = read(index);
    coming_index_ = index + 1;
    if (coming_index_ < source_->size() && !holds(coming_index_))
      coming_ = std::async(std::launch::async,
                           [source = source_, next = coming_index_] { return source->read(next); });
    return frame;
  }

  /// Reads frames that will be asked for next, two at a time; as many as there is room for.
  void read_ahead(const std::set<int>& indices) {
    std::vector<int> missing;
    for (const int index : indices)
      if (!holds(index)) missing.push_back(index);
    if (missing.size() > capacity_) missing.resize(capacity_);
    for (std::size_t i = 0; i < missing.size(); i += 2) {
      std::future<Frame> beside;
      if (i + 1 < missing.size())
        beside =
            std::async(std::launch::async, [this, index = missing[i + 1]] { return source_->read(index); });
      (void)read(missing[i]);
      if (!beside.valid()) continue;
      frames_.push_front(beside.get());
      frames_.front().index = missing[i + 1];
      if (frames_.size() > capacity_) frames_.pop_back();
    }
  }

 private:
  [[nodiscard]] bool holds(int index) const {
    return std::any_of(frames_.begin(), frames_.end(), [&](const Frame& f) { return f.index == index; });
  }
  void keep(Frame frame) {
    frames_.push_front(std::move(frame));
    if (frames_.size() > capacity_) frames_.pop_back();
  }

  const FrameSource* source_;
  std::size_t capacity_;
  std::list<Frame> frames_;  // used last first
  std::future<Frame> coming_;
  int coming_index_ = 0;
};

}  // namespace stillpoint
