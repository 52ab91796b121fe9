#include "ui/session/frame_neighbours.hpp"

#include <algorithm>

#include "ui/session/shown_run.hpp"

namespace stillpoint {

std::vector<std::shared_ptr<const FrameRecord>> history_of(int index,
                                                           const std::function<FrameRecord(int)>& record) {
  std::vector<std::shared_ptr<const FrameRecord>> history;
  for (int i = index - 1; i >= std::max(0, index - kHistoryFrames); --i)
    history.push_back(std::make_shared<const FrameRecord>(record(i)));
  return history;
}

std::shared_ptr<const FrameView> alone(const FrameView& view) {
  FrameView kept = view;
  kept.before.reset();
  kept.history.clear();
  kept.record = nullptr;
  return hold(std::move(kept), view.record != nullptr ? std::optional(*view.record) : std::nullopt);
}

void clear_times(FrameView& view) {
  view.motion.tracks_ms = 0.0;
  for (MotionRound& round : view.motion.rounds) {
    round.forward.ms = round.backward.ms = {};
    round.union_ms = round.removal_ms = 0.0;
  }
  view.depth_motion.ms = {};
  view.colour_motion.ms = {};
  for (ColourReference& reference : view.colour_motion.references) reference.ms = 0.0;
  for (ReferenceEvidence& evidence : view.depth_motion.references) evidence.ms = 0.0;
}

}  // namespace stillpoint
