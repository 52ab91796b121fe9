#pragma once

#include <memory>
#include <string>

#include "core/motion/stage_log.hpp"
#include "ui/panels/frame_pictures.hpp"

namespace stillpoint {

/// Draws a stage's pictures: coloured once, kept as long as frame and stage stay.
class StagePainter {
 public:
  /// @param variant tells apart what one frame has several of
  void draw(const UiFrame& frame, const char* id, const Layer& picture, int variant, PanelsShared& shared,
            const FramePlace& place, ImVec2 size);

 private:
  FrameTexture ground_, over_ = FrameTexture::cover();
};

/// What the signs and colours of a picture mean; empty for one that needs no words.
[[nodiscard]] std::vector<LegendEntry> legend_of(const UiFrame& frame, const Layer& picture);

}  // namespace stillpoint
