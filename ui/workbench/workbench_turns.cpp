#include <algorithm>
#include <cmath>
#include <limits>

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
  frame.redraw_after_s = std::min(frame.redraw_after_s, next_turn_s_);
}

std::vector<const PlacedPanel*> Workbench::waiting_tiles(const std::vector<PlacedPanel>& placed) {
  // What is looked at while it moves comes first; numbers and curves that change faster are not read.
  constexpr double kBetweenTurnsS = 0.1;  // s, of what need not keep up while playing
  constexpr double kEpsilonS = 1e-6;      // s: the clock adds up sixtieths
  std::vector<const PlacedPanel*> waiting;
  // Of another sequence none has shown anything: what was shown of the one before goes.
  const bool all_new = std::none_of(placed.begin(), placed.end(), [this](const PlacedPanel& panel) {
    const auto tile = tile_views_.find(panel.panel);
    return tile != tile_views_.end() && tile->second.view != nullptr &&
           tile->second.view->title == turning_to_->title;
  });
  if (all_new) tile_views_.clear();
  for (const PlacedPanel& panel : placed) {
    const auto [found, added] = tile_views_.try_emplace(panel.panel);
    TileView& tile = found->second;
    const Panel* shown = find_panel(panel.panel);
    // An image whose overlays follow is shown by panels that are worth looking at without them.
    if (turning_to_->current->image_alone && tile.view != nullptr && shown != nullptr &&
        !shown->shows_image_alone() && tile.view->title == turning_to_->title)
      continue;
    // Only another frame of the same sequence is worth waiting for, or the first, or what lies over an image
    // that was shown alone: all else is little work.
    if (tile.view == nullptr ? added && !all_new
                             : tile.view->title != turning_to_->title ||
                                   (tile.view->current->index == turning_to_->current->index &&
                                    tile.view->current->image_alone == turning_to_->current->image_alone))
      tile.view = turning_to_;
    if (tile.view == turning_to_) continue;
    const double left_s = tile.taken_s + kBetweenTurnsS - time_s_;
    if (turning_to_->playing && left_s > kEpsilonS && tile.view != nullptr && shown != nullptr &&
        !shown->keeps_up()) {
      next_turn_s_ = std::min(next_turn_s_, left_s);
      continue;
    }
    waiting.push_back(&panel);
  }
  const auto taken_in = [this](const PlacedPanel* panel) { return tile_views_[panel->panel].taken; };
  std::stable_sort(waiting.begin(), waiting.end(), [&](const PlacedPanel* a, const PlacedPanel* b) {
    // While playing each has its turn; else the wait is over soon.
    if (turning_to_->playing && taken_in(a) != taken_in(b)) return taken_in(a) < taken_in(b);
    if (keeps_up(*a) != keeps_up(*b)) return keeps_up(*a);
    return taken_in(a) < taken_in(b);
  });
  return waiting;
}

bool Workbench::keeps_up(const PlacedPanel& tile) const {
  const Panel* panel = find_panel(tile.panel);
  return panel != nullptr && panel->keeps_up();
}

void Workbench::take_turns(const std::vector<PlacedPanel>& placed) {
  constexpr float kShareAtOnce = 0.25F;    // of the work that all tiles are
  constexpr float kWorkOfPictures = 2.0F;  // for that of plots and tables of the same area
  ++drawn_;
  next_turn_s_ = std::numeric_limits<double>::infinity();
  level_ = true;
  if (turning_to_ == nullptr) return tile_views_.clear();
  std::erase_if(tile_views_, [&](const auto& tile) {
    return std::none_of(placed.begin(), placed.end(),
                        [&](const PlacedPanel& panel) { return panel.panel == tile.first; });
  });
  const auto work = [&](const PlacedPanel& panel) {
    return panel.rect.width * panel.rect.height * (keeps_up(panel) ? kWorkOfPictures : 1.0F);
  };
  float all = 0.0F, taken = 0.0F;
  for (const PlacedPanel& panel : placed) all += work(panel);
  for (const PlacedPanel* panel : waiting_tiles(placed)) {
    if (taken > 0.0F && taken + work(*panel) > kShareAtOnce * all) {
      next_turn_s_ = 0.0;
      break;
    }
    taken += work(*panel);
    tile_views_[panel->panel] = {turning_to_, drawn_, time_s_};
  }
  level_ = std::isinf(next_turn_s_);
}

const SessionView& Workbench::view_of(const std::string& tile) const {
  const auto found = tile_views_.find(tile);
  return found == tile_views_.end() || found->second.view == nullptr ? *session_ : *found->second.view;
}

bool Workbench::has_view(const std::string& tile) const {
  const auto found = tile_views_.find(tile);
  return found == tile_views_.end() || found->second.view != nullptr;
}

}  // namespace stillpoint
