#include "core/inspect/frame_view.hpp"

#include "core/motion/stage_log.hpp"

namespace stillpoint {

std::shared_ptr<const StageLog> no_stages() { return std::make_shared<const StageLog>(); }

const StageLog* stages_with(const FrameView& view, const std::string& layer) {
  for (const auto* log : {&view.motion, &view.motion_beside, &view.odometry})
    if (*log && (*log)->layer(layer) != nullptr) return log->get();
  return nullptr;
}

}  // namespace stillpoint
