#include "app/layered_frames.hpp"

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/inspect/run_view.hpp"

namespace stillpoint {

LayeredFrames::LayeredFrames(const OpenedRun& run, std::vector<std::string> layers)
    : cache_(*run.source),
      shown_(*run.source, cache_, ReplayableRun(*run.source, run.recorded)),
      wanted_(std::move(layers)) {}

std::shared_ptr<const FrameView> LayeredFrames::view(int index) {
  while (shown_.track().seen() <= index && !shown_.track().can_repeat_motion(index)) shown_.catch_up_one();
  return shown_.frame_view(index);
}

std::vector<const Layer*> LayeredFrames::layers_of(const FrameView& view) {
  std::vector<const Layer*> layers;
  for (const std::string& id : wanted_)
    if (const StageLog* log = stages_with(view, id)) {
      layers.push_back(log->layer(id));
      found_.insert(id);
    }
  return layers;
}

void check_layers(const std::vector<std::string>& wanted, const std::set<std::string>& found) {
  for (const std::string& id : wanted)
    if (found.count(id) == 0)
      throw InputError(fmt::format("--layers {}: no stage of any frame has a layer of that id", id));
}

}  // namespace stillpoint
