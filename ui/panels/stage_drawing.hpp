#pragma once

#include <memory>
#include <string>

#include "ui/panels/frame_pictures.hpp"
#include "ui/session/stage_pictures.hpp"

namespace stillpoint {

/// Draws a stage's pictures: coloured once, kept as long as frame and stage stay.
class StagePainter {
 public:
  /// @param variant tells apart what one frame has several of
  void draw(const UiFrame& frame, const char* id, const StagePicture& picture, int variant,
            PanelsShared& shared, const FramePlace& place, ImVec2 size);

 private:
  FrameTexture ground_, over_;
};

/// What the signs and colours of a picture mean; empty for one that needs no words.
[[nodiscard]] std::vector<LegendEntry> legend_of(const UiFrame& frame, const StagePicture& picture);

}  // namespace stillpoint
