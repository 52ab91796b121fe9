#pragma once

#include <utility>
#include <vector>

#include "core/sequence/source.hpp"

namespace stillpoint {

/// The first frames of a sequence, held in memory and, if asked, at another size: what is timed on them holds
/// no reading and no decoding.
class MemorySource : public FrameSource {
 public:
  MemorySource(const FrameSource& source, int frames, const cv::Size& size);

  [[nodiscard]] const std::string& name() const override { return source_.name(); }
  [[nodiscard]] const Camera& camera() const override { return camera_; }
  [[nodiscard]] int size() const override { return static_cast<int>(frames_.size()); }
  [[nodiscard]] double timestamp(int index) const override { return source_.timestamp(index); }
  [[nodiscard]] Frame read(int index) const override { return frames_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] FrameTruth truth(int) const override { return {}; }
  [[nodiscard]] const Trajectory& ground_truth() const override { return none_; }
  [[nodiscard]] bool has_depth() const override { return source_.has_depth(); }
  [[nodiscard]] bool has_masks() const override { return false; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return source_.warnings(); }

 private:
  const FrameSource& source_;
  Camera camera_;
  std::vector<Frame> frames_;
  Trajectory none_;
};

}  // namespace stillpoint
