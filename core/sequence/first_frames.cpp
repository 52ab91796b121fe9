#include "core/sequence/first_frames.hpp"

#include <utility>

namespace stillpoint {
namespace {

class FirstFrames final : public FrameSource {
 public:
  FirstFrames(std::unique_ptr<FrameSource> whole, int count) : whole_(std::move(whole)), count_(count) {}

  [[nodiscard]] const std::string& name() const override { return whole_->name(); }
  [[nodiscard]] const Camera& camera() const override { return whole_->camera(); }
  [[nodiscard]] int size() const override { return count_; }
  [[nodiscard]] double timestamp(int index) const override { return whole_->timestamp(index); }
  [[nodiscard]] std::vector<double> recorded_stamps() const override { return whole_->recorded_stamps(); }
  [[nodiscard]] Frame read(int index) const override { return whole_->read(index); }
  [[nodiscard]] FrameTruth truth(int index) const override { return whole_->truth(index); }
  [[nodiscard]] const Trajectory& ground_truth() const override { return whole_->ground_truth(); }
  [[nodiscard]] bool has_depth() const override { return whole_->has_depth(); }
  [[nodiscard]] bool has_masks() const override { return whole_->has_masks(); }
  [[nodiscard]] std::string why_not(FramePart part) const override { return whole_->why_not(part); }
  [[nodiscard]] std::optional<double> depth_late_s() const override { return whole_->depth_late_s(); }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return whole_->warnings(); }
  [[nodiscard]] std::vector<std::string> contents() const override { return whole_->contents(); }

 private:
  std::unique_ptr<FrameSource> whole_;
  int count_;
};

}  // namespace

std::unique_ptr<FrameSource> first_frames(std::unique_ptr<FrameSource> source, int count) {
  if (count >= source->size()) return source;
  return std::make_unique<FirstFrames>(std::move(source), count);
}

}  // namespace stillpoint
