#include "core/sequence/excerpt.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"
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
  ExportedFrames exported;
  std::vector<int> readable;
  for (const int frame : frames)
    (source.read(frame).readable() ? readable : exported.unreadable).push_back(frame);
  if (readable.empty())
    throw InputError(
        fmt::format("{}: none of the {} frames to export can be read", source.name(), frames.size()));
  exported.written = write_sequence(Excerpt(source, readable), folder,
                                    {.force = force, .threads = 2, .progress = progress, .stop = stop});
  return exported;
}

}  // namespace stillpoint
