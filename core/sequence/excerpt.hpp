#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>

#include "core/sequence/source.hpp"

namespace stillpoint {

/// Some frames of a sequence as a sequence of their own, with the ground truth of their time.
class Excerpt : public FrameSource {
 public:
  /// @param whole must outlive the excerpt
  /// @param frames indices into `whole`, ascending, at least one
  Excerpt(const FrameSource& whole, std::vector<int> frames);

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const Camera& camera() const override { return whole_->camera(); }
  [[nodiscard]] int size() const override { return static_cast<int>(frames_.size()); }
  [[nodiscard]] double timestamp(int index) const override { return whole_->timestamp(index_of(index)); }
  [[nodiscard]] Frame read(int index) const override;
  [[nodiscard]] FrameTruth truth(int index) const override { return whole_->truth(index_of(index)); }
  [[nodiscard]] const Trajectory& ground_truth() const override { return ground_truth_; }
  [[nodiscard]] bool has_depth() const override { return whole_->has_depth(); }
  [[nodiscard]] bool has_masks() const override { return whole_->has_masks(); }
  [[nodiscard]] std::string why_not(FramePart part) const override { return whole_->why_not(part); }
  [[nodiscard]] std::optional<double> depth_late_s() const override { return whole_->depth_late_s(); }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  [[nodiscard]] int index_of(int index) const { return frames_[static_cast<std::size_t>(index)]; }

  const FrameSource* whole_;
  std::vector<int> frames_;
  std::string name_;
  Trajectory ground_truth_;
  std::vector<std::string> warnings_;
};

/// What was exported.
struct ExportedFrames {
  int written = 0;
  std::vector<int> unreadable;  ///< of the source's: they keep their places, without images
  std::int64_t too_far = 0;     ///< pixels whose depth 16 bits cannot hold: written as not measured
  double depth_units = 0.0;     ///< a metre, as stored
};

/// Writes some frames of a sequence as a TUM RGB-D folder (write_sequence) that shows a method the same
/// images at the same times.
/// @param stop when it turns true, it ends with the frames at hand
/// @param frames at least one
/// @throws InputError as write_sequence does
ExportedFrames export_frames(const FrameSource& source, const std::vector<int>& frames,
                             const std::filesystem::path& folder, bool force,
                             const std::function<void(int done, int total)>& progress = {},
                             const std::atomic<bool>* stop = nullptr);

}  // namespace stillpoint
