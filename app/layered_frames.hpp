#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/inspect/shown_run.hpp"
#include "core/run/open_run.hpp"

namespace stillpoint {

/// Frames of a finished run with layers of their stages, which are worked out again for it.
class LayeredFrames {
 public:
  /// @param run outlives this @param layers ids
  LayeredFrames(const OpenedRun& run, std::vector<std::string> layers);

  /// @param index of a frame the run has; quickest in order
  [[nodiscard]] std::shared_ptr<const FrameView> view(int index);
  /// The layers asked for that the frame has.
  [[nodiscard]] std::vector<const Layer*> layers_of(const FrameView& view);
  /// Ids that a frame had so far.
  [[nodiscard]] const std::set<std::string>& found() const { return found_; }

 private:
  FrameCache cache_;
  ShownRun shown_;
  std::vector<std::string> wanted_;
  std::set<std::string> found_;
};

/// @throws InputError naming one of `wanted` that is not in `found`
void check_layers(const std::vector<std::string>& wanted, const std::set<std::string>& found);

}  // namespace stillpoint
