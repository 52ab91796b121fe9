#pragma once

#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/sequence/generated/generated_sequence.hpp"

namespace stillpoint {

/// The first frames of a generated sequence, held in memory, of which some in a row are so far out of focus
/// that no corner is left: depth, poses and all else stay as they are.
class DefocusedSource : public FrameSource {
 public:
  static constexpr int kFirst = 10, kLast = 14;  // frames out of focus

  explicit DefocusedSource(const char* kind, int frames = 20, double sigma_px = 14.0)
      : source_(make_generated_sequence(kind, frames, 1)) {
    for (int i = 0; i < frames; ++i) {
      frames_.push_back(source_->read(i));
      if (i < kFirst || i > kLast) continue;
      Frame& frame = frames_.back();
      cv::GaussianBlur(frame.colour, frame.colour, {}, sigma_px);
      cv::cvtColor(frame.colour, frame.gray, cv::COLOR_BGR2GRAY);
    }
  }

  [[nodiscard]] const std::string& name() const override { return source_->name(); }
  [[nodiscard]] const Camera& camera() const override { return source_->camera(); }
  [[nodiscard]] int size() const override { return static_cast<int>(frames_.size()); }
  [[nodiscard]] double timestamp(int index) const override { return source_->timestamp(index); }
  [[nodiscard]] Frame read(int index) const override { return frames_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] FrameTruth truth(int index) const override { return source_->truth(index); }
  [[nodiscard]] const Trajectory& ground_truth() const override { return source_->ground_truth(); }
  [[nodiscard]] bool has_depth() const override { return true; }
  [[nodiscard]] bool has_masks() const override { return true; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return source_->warnings(); }

 private:
  std::unique_ptr<FrameSource> source_;
  std::vector<Frame> frames_;
};

}  // namespace stillpoint
