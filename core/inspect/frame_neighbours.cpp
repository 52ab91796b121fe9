#include "core/inspect/frame_neighbours.hpp"

#include <algorithm>

#include "core/inspect/run_view.hpp"
#include "core/inspect/shown_run.hpp"

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
  for (auto* log : {&view.motion, &view.motion_beside, &view.odometry}) {
    if (!*log) continue;
    StageLog timeless = **log;
    for (Stage& stage : timeless.stages) stage.ms = 0.0;
    *log = std::make_shared<const StageLog>(std::move(timeless));
  }
}

}  // namespace stillpoint
