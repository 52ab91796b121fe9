#include <algorithm>

#include "core/inspect/frame_view.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/workbench/workbench.hpp"

// When another frame is shown, its tiles take to it in turn, so that no frame of the interface draws them
// all.

namespace stillpoint {

void Workbench::draw_in_turn(UiFrame& frame, std::shared_ptr<const SessionView> session) {
  const SessionView* view = session.get();
  turning_to_ = std::move(session);
  draw(frame, view);
  turning_to_.reset();
  if (level_) return;
  frame.busy = true;
  frame.redraw_after_s = 0.0;
}

void Workbench::take_turns(const std::vector<PlacedPanel>& placed) {
  constexpr float kShareAtOnce = 0.34F;  // of the area of those that wait
  ++drawn_;
  level_ = true;
  if (turning_to_ == nullptr) return tile_views_.clear();
  std::erase_if(tile_views_, [&](const auto& tile) {
    return std::none_of(placed.begin(), placed.end(),
                        [&](const PlacedPanel& panel) { return panel.panel == tile.first; });
  });
  const auto area = [](const PlacedPanel* panel) { return panel->rect.width * panel->rect.height; };
  std::vector<const PlacedPanel*> waiting;
  float all = 0.0F, taken = 0.0F;
  for (const PlacedPanel& panel : placed) {
    TileView& tile = tile_views_[panel.panel];
    // An image whose overlays follow is shown by panels that are worth looking at without them.
    const Panel* shown = find_panel(panel.panel);
    if (turning_to_->current->image_alone && tile.view != nullptr && shown != nullptr &&
        !shown->shows_image_alone() && tile.view->title == turning_to_->title)
      continue;
    // Only another frame of the same sequence is worth waiting for: all else is little work.
    if (tile.view == nullptr || tile.view->title != turning_to_->title ||
        tile.view->current->index == turning_to_->current->index)
      tile.view = turning_to_;
    all += area(&panel);
    if (tile.view != turning_to_) waiting.push_back(&panel);
  }
  const auto taken_in = [this](const PlacedPanel* panel) { return tile_views_[panel->panel].taken; };
  const auto is_picture = [this](const PlacedPanel* panel) {
    const Panel* found = find_panel(panel->panel);
    return found != nullptr && found->previews();
  };
  std::stable_sort(waiting.begin(), waiting.end(), [&](const PlacedPanel* a, const PlacedPanel* b) {
    if (taken_in(a) != taken_in(b)) return taken_in(a) < taken_in(b);
    return is_picture(a) && !is_picture(b);
  });
  for (const PlacedPanel* panel : waiting) {
    if (taken > 0.0F && taken + area(panel) > kShareAtOnce * all) {
      level_ = false;
      break;
    }
    taken += area(panel);
    tile_views_[panel->panel] = {turning_to_, drawn_};
  }
}

const SessionView& Workbench::view_of(const std::string& tile) const {
  const auto found = tile_views_.find(tile);
  return found == tile_views_.end() ? *session_ : *found->second.view;
}

}  // namespace stillpoint
