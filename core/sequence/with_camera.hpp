#pragma once

#include "core/sequence/source.hpp"

namespace stillpoint {

/// The same frames as a source's under another camera. Refers to the source, which must outlive it.
class WithCamera : public FrameSource {
 public:
  WithCamera(const FrameSource& source, Camera camera) : source_(source), camera_(std::move(camera)) {}

  [[nodiscard]] const std::string& name() const override { return source_.name(); }
  [[nodiscard]] const Camera& camera() const override { return camera_; }
  [[nodiscard]] int size() const override { return source_.size(); }
  [[nodiscard]] double timestamp(int index) const override { return source_.timestamp(index); }
  [[nodiscard]] std::vector<double> recorded_stamps() const override { return source_.recorded_stamps(); }
  [[nodiscard]] Frame read(int index) const override { return source_.read(index); }
  [[nodiscard]] FrameTruth truth(int index) const override { return source_.truth(index); }
  [[nodiscard]] const Trajectory& ground_truth() const override { return source_.ground_truth(); }
  [[nodiscard]] bool has_depth() const override { return source_.has_depth(); }
  [[nodiscard]] bool has_masks() const override { return source_.has_masks(); }
  [[nodiscard]] std::string why_not(FramePart part) const override { return source_.why_not(part); }
  [[nodiscard]] std::optional<double> depth_late_s() const override { return source_.depth_late_s(); }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return source_.warnings(); }
  [[nodiscard]] std::vector<std::string> contents() const override { return source_.contents(); }

 private:
  const FrameSource& source_;
  Camera camera_;
};

}  // namespace stillpoint
