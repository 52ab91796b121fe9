// The workbench's named actions, in the order of its menus.
#include <fmt/format.h>

#include <algorithm>

#include "core/inspect/frame_view.hpp"
#include "ui/panels/panel_command.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/theme/icons.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {
namespace {

constexpr Modifiers kCtrlShift{.ctrl = true, .shift = true};

}  // namespace

void Workbench::add_actions() {
  actions_.add({.name = "open",
                .title = "Open a sequence…",
                .group = "File",
                .icon = icons::kFolderOpen,
                .keys = {{Key::kO, kCtrl}},
                .enabled = [this] { return static_cast<bool>(host_.open); },
                .run = [this] { open_dialog_.open(recent_.empty() ? "" : recent_.front(), ""); }});
  actions_.add({.name = "open_demo",
                .title = "Open the generated demo",
                .group = "File",
                .icon = icons::kFilm,
                .enabled = [this] { return static_cast<bool>(host_.open); },
                .run = [this] { after_frame_ = [this] { host_.open("generated:walking_static"); }; }});
  actions_.add({.name = "reopen",
                .title = "Open this sequence again",
                .group = "File",
                .keys = {{Key::kF5, {}}},
                .enabled = [this] { return session_ != nullptr && host_.reopen; },
                .run = [this] { after_frame_ = [this] { host_.reopen(""); }; }});
  actions_.add({.name = "hand_on",
                .title = "Hand this session on as a folder…",
                .group = "File",
                .icon = icons::kFolderOpen,
                .enabled = [this] { return session_ != nullptr && session_->processed > 0 && host_.request; },
                .off = "No frame has been processed yet.",
                .run = [this] { hand_on_dialog_ = {.open = true, .opened_now = true}; }});
  actions_.add({.name = "quit", .title = "Quit", .group = "File", .keys = {{Key::kQ, kCtrl}}, .run = [this] {
                  if (frame_ != nullptr) frame_->quit = true;
                }});
  add_playback_actions();
  add_debug_actions();
  add_run_actions();
  add_view_actions();
  add_layout_actions();
  add_panel_actions();
  actions_.add({.name = "palette",
                .title = "Command palette…",
                .group = "Help",
                .icon = icons::kSearch,
                .keys = {{Key::kP, kCtrlShift}},
                .run = [this] { palette_ = {.open = true, .opened_now = true}; }});
  actions_.add({.name = "shortcuts",
                .title = "Keys",
                .group = "Help",
                .icon = icons::kKeyboard,
                .keys = {{Key::kSlash, kShift}, {Key::kF1, {}}},
                .run = [this] { shortcuts_open_ = !shortcuts_open_; }});
}

void Workbench::add_playback_actions() {
  const auto add = [this](const char* name, const char* title, const char* icon, KeyChord key, bool repeats,
                          const char* off, std::function<std::optional<int>()> target) {
    actions_.add({.name = name,
                  .title = title,
                  .group = "Playback",
                  .icon = icon,
                  .keys = {key},
                  .repeats = repeats,
                  .enabled = [this, target] { return can_go() && target().has_value(); },
                  .off = off,
                  .run = [this, target] { go_to(*target()); }});
  };
  using Target = std::optional<int>;
  actions_.add({.name = "play_pause",
                .title = "Play or pause",
                .group = "Playback",
                .icon = icons::kPlay,
                .keys = {{Key::kSpace, {}}},
                .enabled = [this] { return session_ != nullptr && host_.play; },
                .checked = [this] { return session_ != nullptr && session_->playing; },
                .run = [this] { host_.play(!session_->playing); }});
  const auto add_step = [this](const char* name, const char* title, const char* icon, Key key, int by) {
    actions_.add({.name = name,
                  .title = title,
                  .group = "Playback",
                  .icon = icon,
                  .keys = {{key, {}}},
                  .repeats = true,
                  .enabled =
                      [this, by] {
                        const int frame = can_go() ? session_->current->index + by : -1;
                        return frame >= 0 && frame < session_->frame_count;
                      },
                  .off = by > 0 ? "This is the last frame." : "This is the first frame.",
                  .run = [this, by] { step(by); }});
  };
  add_step("step", "Step forward", icons::kStepForward, Key::kRight, 1);
  add_step("step_back", "Step back", icons::kStepBack, Key::kLeft, -1);
  add("first", "First frame", icons::kFastBack, {Key::kHome, {}}, false, "", []() -> Target { return 0; });
  add("last_processed", "Last processed frame", icons::kFastForward, {Key::kEnd, {}}, false, "",
      [this]() -> Target { return std::max(0, session_->processed - 1); });
  add("last", "Last frame of the sequence", icons::kFlag, {Key::kEnd, kCtrl}, false, "",
      [this]() -> Target { return session_->frame_count - 1; });
  add("next_keyframe", "Next keyframe", icons::kChevronRight, {Key::kRightBracket, {}}, true,
      "No keyframe after this frame is known yet.", [this] { return next_keyframe(*session_); });
  add("previous_keyframe", "Previous keyframe", icons::kChevronLeft, {Key::kLeftBracket, {}}, true,
      "There is no keyframe before this frame.", [this] { return previous_keyframe(*session_); });
  add("next_lost", "Next lost frame", icons::kWarning, {Key::kL, {}}, true,
      "No frame after this one is lost.", [this] { return next_lost_frame(*session_); });
}

void Workbench::add_view_actions() {
  actions_.add({.name = "toggle_theme",
                .title = "Light or dark theme",
                .group = "View",
                .icon = icons::kContrast,
                .keys = {{Key::kT, kCtrl}},
                .run = [this] {
                  if (frame_ == nullptr) return;
                  ThemeName& wanted = frame_->wanted_look.theme;
                  wanted = wanted == ThemeName::kDark ? ThemeName::kLight : ThemeName::kDark;
                }});
  constexpr float kStep = 1.1F;  // times the size, each press
  actions_.add({.name = "scale_up",
                .title = "Larger interface",
                .group = "View",
                .keys = {{Key::kEqual, kCtrl}, {Key::kEqual, kCtrlShift}},
                .run = [this] { scale_by(kStep); }});
  actions_.add({.name = "scale_down",
                .title = "Smaller interface",
                .group = "View",
                .keys = {{Key::kMinus, kCtrl}},
                .run = [this] { scale_by(1.0F / kStep); }});
  actions_.add({.name = "scale_reset",
                .title = "Interface at its own size",
                .group = "View",
                .keys = {{Key::k0, kCtrl}},
                .run = [this] { scale_by(0.0F); }});
  actions_.add(
      {.name = "maximise",
       .title = "Maximise the panel under the mouse, or restore",
       .group = "View",
       .icon = icons::kMaximise,
       .keys = {{Key::kM, {}}},
       .enabled = [this] { return session_ != nullptr && (!maximised_.empty() || !hovered_panel_.empty()); },
       .off = "The mouse is on no panel.",
       .run = [this] { maximised_ = maximised_.empty() ? hovered_panel_ : ""; }});
  actions_.add({.name = "next_tab",
                .title = "Next tab of the tile under the mouse",
                .group = "View",
                .keys = {{Key::kTab, kCtrl}},
                .enabled =
                    [this] {
                      return std::any_of(places_.begin(), places_.end(), [this](const PlacedPanel& place) {
                        return place.panel == hovered_panel_ && !place.tabs.empty();
                      });
                    },
                .off = "The tile under the mouse has one panel.",
                .run = [this] { after_frame_ = [this] { next_tab(); }; }});
  actions_.add({.name = "reset_layout",
                .title = "Reset layout",
                .group = "View",
                .icon = icons::kLayout,
                .keys = {{Key::kR, kCtrlShift}},
                .run = [this] {
                  const std::string method =
                      session_ == nullptr ? Config().run.method : session_->config.run.method;
                  after_frame_ = [this, method] { set_layout(default_layout(method)); };
                }});
}

void Workbench::add_panel_actions() {
  for (const auto& panel : panels_) {
    const std::string name = panel->name();
    actions_.add({.name = "panel." + name,
                  .title = "Show or hide: " + panel->title(),
                  .group = "Panels",
                  .checked = [this, name] { return contains(layout_, name) && !is_behind(name); },
                  .run = [this, name] { after_frame_ = [this, name] { toggle_panel(name); }; }});
  }
  for (const auto& panel : panels_)
    for (PanelCommand& command : panel->commands()) add_panel_command(panel->name(), std::move(command));
}

void Workbench::add_panel_command(const std::string& panel, PanelCommand command) {
  const auto shared = std::make_shared<const PanelCommand>(std::move(command));
  actions_.add(
      {.name = shared->name,
       .title = shared->title,
       .group = shared->group,
       .icon = shared->icon,
       .keys = shared->keys,
       .repeats = shared->repeats,
       .enabled =
           [this, shared] { return session_ != nullptr && (!shared->enabled || shared->enabled(*session_)); },
       .off = shared->off,
       .run =
           [this, shared, panel] {
             PanelActions wanted;
             shared->run(*session_, wanted);
             carry_out(wanted);
             if (!shared->shows || (contains(layout_, panel) && !is_behind(panel))) return;
             after_frame_ = [this, panel] { toggle_panel(panel); };
           }});
}

void Workbench::go_to(int frame) {
  if (!can_go()) return;
  if (session_->playing && host_.play) host_.play(false);
  host_.go_to_frame(std::clamp(frame, 0, session_->frame_count - 1));
}

void Workbench::step(int by) {
  // A key that is held is to stop where it is let go of.
  if (!host_.step || actions_.key_is_held()) return go_to(session_->current->index + by);
  if (session_->playing && host_.play) host_.play(false);
  host_.step(by);
}

void Workbench::toggle_panel(const std::string& name) {
  maximised_.clear();
  if (is_behind(name)) return bring_to_front(name);
  if (contains(layout_, name)) return remove_panel(layout_, name);
  add_panel(layout_, name, tiles_area_);
  bring_to_front(name);
}

void Workbench::scale_by(float factor) {
  if (frame_ == nullptr) return;
  float& scale = frame_->wanted_look.scale;
  scale = factor > 0.0F ? std::clamp(scale * factor, 0.5F, 4.0F) : 1.0F;
}

}  // namespace stillpoint
