#include "core/sequence/excerpt.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/sequence/write_sequence.hpp"

namespace stillpoint {
namespace {

constexpr double kTruthMargin = 0.2;  // s before the first and after the last frame

}  // namespace

Excerpt::Excerpt(const FrameSource& whole, std::vector<int> frames)
    : whole_(&whole),
      frames_(std::move(frames)),
      name_(fmt::format("{} frames {} to {}", whole.name(), frames_.front(), frames_.back())) {
  const double from = whole.timestamp(frames_.front()) - kTruthMargin;
  const double to = whole.timestamp(frames_.back()) + kTruthMargin;
  std::copy_if(whole.ground_truth().begin(), whole.ground_truth().end(), std::back_inserter(ground_truth_),
               [&](const StampedPose& pose) { return pose.timestamp >= from && pose.timestamp <= to; });
}

Frame Excerpt::read(int index) const {
  Frame frame = whole_->read(index_of(index));
  frame.index = index;
  return frame;
}

ExportedFrames export_frames(const FrameSource& source, const std::vector<int>& frames,
                             const std::filesystem::path& folder, bool force,
                             const std::function<void(int done, int total)>& progress,
                             const std::atomic<bool>* stop) {
  const WrittenSequence written = write_sequence(
      Excerpt(source, frames), folder, {.force = force, .threads = 2, .progress = progress, .stop = stop});
  ExportedFrames exported{.written = written.frames,
                          .unreadable = {},
                          .too_far = written.too_far,
                          .depth_units = written.depth_units};
  for (const int at : written.unreadable) exported.unreadable.push_back(frames[static_cast<std::size_t>(at)]);
  return exported;
}

}  // namespace stillpoint
