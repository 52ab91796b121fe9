#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "core/sequence/source.hpp"

namespace stillpoint {

/// A sequence whose frames and masks are made once, when they are first asked for: ray casting a frame takes
/// longer than any method takes over it, and every method sees the same sequence. Holds some 2.5 MB a frame.
class RenderedSequence : public FrameSource {
 public:
  explicit RenderedSequence(std::unique_ptr<FrameSource> source)
      : source_(std::move(source)), takes_(static_cast<std::size_t>(source_->size())) {}

  [[nodiscard]] const std::string& name() const override { return source_->name(); }
  [[nodiscard]] const Camera& camera() const override { return source_->camera(); }
  [[nodiscard]] int size() const override { return source_->size(); }
  [[nodiscard]] double timestamp(int index) const override { return source_->timestamp(index); }
  [[nodiscard]] Frame read(int index) const override {
    Take& take = takes_[static_cast<std::size_t>(index)];
    std::call_once(take.read, [&] { take.frame = source_->read(index); });
    return take.frame;
  }
  [[nodiscard]] FrameTruth truth(int index) const override {
    Take& take = takes_[static_cast<std::size_t>(index)];
    std::call_once(take.known, [&] { take.truth = source_->truth(index); });
    return take.truth;
  }
  [[nodiscard]] const Trajectory& ground_truth() const override { return source_->ground_truth(); }
  [[nodiscard]] bool has_depth() const override { return source_->has_depth(); }
  [[nodiscard]] bool has_masks() const override { return source_->has_masks(); }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return source_->warnings(); }

 private:
  struct Take {
    std::once_flag read, known;
    Frame frame;
    FrameTruth truth;
  };

  std::unique_ptr<FrameSource> source_;
  mutable std::vector<Take> takes_;
};

}  // namespace stillpoint
