// The part of RunTrack that has method `stillpoint`'s motion stage again from records.
#include "core/odometry/motion_replay.hpp"
#include "ui/session/run_track.hpp"

namespace stillpoint {

int RunTrack::memory_before(int index) const {
  const auto after = memories_.lower_bound(index);
  return after == memories_.begin() ? kNone : std::prev(after)->first;
}

void RunTrack::add_references(int index, int memory, std::set<int>& frames) const {
  const auto has_view = [this](int i) { return has_view_[static_cast<std::size_t>(i)] != 0; };
  for (const int gap : reference_gaps(config().depth_motion, index)) {
    // The youngest that is old enough, else the oldest there is: as Odometry chooses.
    int chosen = index - gap;
    while (chosen >= 0 && !has_view(chosen)) --chosen;
    if (chosen < 0)
      for (chosen = 0; chosen < index && !has_view(chosen);) ++chosen;
    if (chosen <= memory) frames.insert(chosen);  // later ones are repeated
  }
}

std::optional<std::set<int>> RunTrack::frames_to_repeat(int index) const {
  const auto& record = records_[static_cast<std::size_t>(index)];
  if (config().run.method != "stillpoint" || !record.motion_pose || index >= seen_) return std::nullopt;
  const int memory = memory_before(index);
  // Of a branch's first frames, what came before it was made otherwise.
  if (begins_at_ > 0 && memory - frames_compared_back(config()) < begins_at_) return std::nullopt;
  std::set<int> frames;
  if (memory != kNone) frames.insert(memory);
  for (int i = memory + 1; i <= index; ++i) {
    add_references(i, memory, frames);
    frames.insert(i);
  }
  return frames;
}

MotionReplay RunTrack::motion_before(int index, const ReadFrame& read) const {
  const int memory = memory_before(index);
  std::set<int> frames = frames_to_repeat(index).value();
  frames.erase(index);
  MotionReplay replay(source_->camera(), config());
  for (const int i : frames) {
    const FrameRecord& record = records_[static_cast<std::size_t>(i)];
    if (i <= memory)
      replay.take(read(i), record, i == memory ? memories_.at(i) : cv::Mat());
    else
      (void)replay.repeat(read(i), record);
  }
  return replay;
}

FrameResult RunTrack::repeat_motion(int index, const ReadFrame& read) const {
  return motion_before(index, read).repeat(read(index), records_[static_cast<std::size_t>(index)]);
}

}  // namespace stillpoint
