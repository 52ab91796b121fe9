// What leads to failures: worst frames, breakpoint hits, bookmarks, a range of frames, ghosts.
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/run/worst_frames.hpp"
#include "ui/session/data_sources.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/theme/icons.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {
namespace {

using Target = std::optional<int>;

}  // namespace

const std::vector<int>& Workbench::worst() {
  const RunView& run = *session_->run;
  const int figure = worst_by_.value_or(usual_figure(run.measured()));
  const WorstKey key{&run, session_->revision, run.records.size(), figure};
  if (!(key == worst_key_)) {
    worst_.clear();
    for (const WorstFrame& frame : worst_frames(run.measured(), figure)) worst_.push_back(frame.index);
    worst_key_ = key;
  }
  return worst_;
}

void Workbench::ask(SessionRequest request) {
  if (host_.request) host_.request(std::move(request));
}

void Workbench::add_debug_actions() {
  const auto add = [this](const char* name, const char* title, const char* icon, KeyChord key,
                          const char* off, std::function<Target()> target) {
    actions_.add({.name = name,
                  .title = title,
                  .group = "Debug",
                  .icon = icon,
                  .keys = key.key == Key::kNone ? std::vector<KeyChord>{} : std::vector{key},
                  .enabled = [this, target] { return can_go() && target().has_value(); },
                  .off = off,
                  .run = [this, target] { go_to(*target()); }});
  };
  const auto here = [this] { return session_->current->index; };
  // Where the list of worst frames led is kept: it is gone through from there.
  const auto add_worst = [this](const char* name, const char* title, const char* icon, KeyChord key,
                                const char* off, std::function<Target()> target) {
    actions_.add({.name = name,
                  .title = title,
                  .group = "Debug",
                  .icon = icon,
                  .keys = {key},
                  .enabled = [this, target] { return can_go() && target().has_value(); },
                  .off = off,
                  .run =
                      [this, target] {
                        worst_gone_to_ = target();
                        go_to(*worst_gone_to_);
                      }});
  };
  add_worst("next_worst", "Next worst frame", icons::kWarning, {Key::kN, {}},
            "No frame is worse than those gone through.",
            [this, here] { return stillpoint::next_worst(worst(), here(), worst_gone_to_); });
  add_worst("previous_worst", "Previous worst frame", icons::kChevronUp, {Key::kN, kShift},
            "The worst frames have not been gone through yet.",
            [this, here] { return stillpoint::previous_worst(worst(), here(), worst_gone_to_); });
  add("next_hit", "Next breakpoint hit", icons::kBug, {Key::kF8, {}}, "No breakpoint holds after this frame.",
      [this, here] { return next_in(hit_frames(session_->debug), here()); });
  add("previous_hit", "Previous breakpoint hit", icons::kBug, {Key::kF8, kShift},
      "No breakpoint holds before this frame.",
      [this, here] { return previous_in(hit_frames(session_->debug), here()); });
  add("next_hurt", "Next frame that removal hurt", icons::kBolt, {Key::kJ, {}},
      "Removal hurt no frame after this one, or was not checked (run.check_removal).",
      [this, here] { return next_in(hurt_frames(session_->debug), here()); });
  add("previous_hurt", "Previous frame that removal hurt", icons::kBolt, {Key::kJ, kShift},
      "Removal hurt no frame before this one, or was not checked (run.check_removal).",
      [this, here] { return previous_in(hurt_frames(session_->debug), here()); });
  add("next_bookmark", "Next bookmark", icons::kBookmark, {Key::kPeriod, {}}, "No bookmark after this frame.",
      [this, here] { return next_in(bookmarked_frames(session_->debug), here()); });
  add("previous_bookmark", "Previous bookmark", icons::kBookmark, {Key::kComma, {}},
      "No bookmark before this frame.",
      [this, here] { return previous_in(bookmarked_frames(session_->debug), here()); });
  add("first_divergence", "Where the first ghost run parts", icons::kRandom, {Key::kD, {}},
      "No run stands beside this one, or none parts from it.",
      [this] { return first_divergence(session_->debug); });
  add_mark_actions();
}

void Workbench::add_mark_actions() {
  const auto can_ask = [this] { return session_ != nullptr && static_cast<bool>(host_.request); };
  actions_.add({.name = "bookmark",
                .title = "Bookmark this frame, or take the bookmark off",
                .group = "Debug",
                .icon = icons::kBookmark,
                .keys = {{Key::kB, {}}},
                .enabled = can_ask,
                .run = [this] { toggle_bookmark(); }});
  actions_.add({.name = "undo",
                .title = "Take back the last change of marks",
                .group = "Debug",
                .icon = icons::kUndo,
                .keys = {{Key::kZ, kCtrl}},
                .enabled = [this, can_ask] { return can_ask() && session_->debug.undo_steps > 0; },
                .off = "No mark was changed since the sequence was opened.",
                .run = [this] { ask(request::Undo{}); }});
  actions_.add({.name = "redo",
                .title = "Make that change of marks again",
                .group = "Debug",
                .keys = {{Key::kZ, {.ctrl = true, .shift = true}}},
                .enabled = [this, can_ask] { return can_ask() && session_->debug.redo_steps > 0; },
                .off = "Nothing was taken back.",
                .run = [this] { ask(request::Redo{}); }});
  const auto add_span = [this, can_ask](const char* name, const char* title, Key key, bool begins) {
    actions_.add({.name = name,
                  .title = title,
                  .group = "Debug",
                  .keys = {{key, {}}},
                  .enabled = can_ask,
                  .run = [this, begins] {
                    const int here = session_->current->index, last = session_->frame_count - 1;
                    const auto& span = session_->debug.span;
                    const int other = span ? (begins ? span->last : span->first) : (begins ? last : 0);
                    // An end beyond the other one begins a new range.
                    const bool crossed = begins ? here > other : here < other;
                    const int end = !crossed ? other : begins ? last : 0;
                    ask(request::Span{span_between(here, end, session_->frame_count), session_->debug.loop});
                  }});
  };
  add_span("range_start", "Range begins here", Key::kI, true);
  add_span("range_end", "Range ends here", Key::kO, false);
  const auto has_span = [this, can_ask] { return can_ask() && session_->debug.span.has_value(); };
  actions_.add({.name = "loop_range",
                .title = "Play the range over and over",
                .group = "Debug",
                .icon = icons::kRefresh,
                .keys = {{Key::kL, kCtrl}},
                .enabled = has_span,
                .off = "No range of frames is selected.",
                .checked = [this] { return session_ != nullptr && session_->debug.loop; },
                .run =
                    [this] {
                      ask(request::Span{session_->debug.span, !session_->debug.loop});
                    }});
  actions_.add({.name = "clear_range",
                .title = "Clear the range",
                .group = "Debug",
                .icon = icons::kClose,
                .enabled = has_span,
                .off = "No range of frames is selected.",
                .run = [this] { ask(request::Span{}); }});
}

void Workbench::toggle_bookmark() {
  const int here = session_->current->index;
  const Bookmark* bookmark = bookmark_at(session_->debug, here);
  if (bookmark == nullptr) {
    ask(request::Bookmarks{with_bookmark(session_->debug.bookmarks, here)});
  } else if (bookmark->note.empty()) {
    ask(request::Bookmarks{without_bookmark(session_->debug.bookmarks, here)});
  } else {
    // A note is not thrown away by a key pressed twice.
    say("This frame's bookmark has a note; it can be deleted in the bookmarks panel.");
  }
}

void Workbench::tell_notice() {
  const std::string notice = session_ == nullptr ? "" : session_->debug.notice;
  if (notice == notice_) return;
  notice_ = notice;
  if (!notice.empty()) say(notice);
}

void Workbench::tell_refused(const Action* refused) {
  if (session_ == nullptr) return refused_.reset();
  if (refused != nullptr && !why_off(*refused).empty()) {
    message_ = why_off(*refused);
    message_is_error_ = false;
    refused_ = {refused->name, message_, session_->current->index};
  }
  if (!refused_) return;
  // What stands in the way is told while it does.
  const bool stands = refused_->told == message_ && refused_->frame == session_->current->index &&
                      why_off(*actions_.find(refused_->action)) == refused_->told &&
                      !is_enabled(*actions_.find(refused_->action));
  if (stands) return;
  if (refused_->told == message_) message_.clear();
  refused_.reset();
}

void Workbench::add_layout_actions() {
  actions_.add({.name = "undo_layout",
                .title = "Take back the last change of the tiles",
                .group = "View",
                .icon = icons::kUndo,
                .keys = {{Key::kZ, {.ctrl = true, .alt = true}}},
                .enabled = [this] { return !layouts_before_.empty(); },
                .off = "The tiles are as they were.",
                .run =
                    [this] {
                      after_frame_ = [this] {
                        set_layout(std::move(layouts_before_.back()));
                        layouts_before_.pop_back();
                        layout_seen_ = layout_;
                      };
                    }});
  int digit = static_cast<int>(Key::k1);
  for (const NamedLayout& layout : named_layouts())
    actions_.add({.name = "layout." + std::string(layout.name),
                  .title = "Layout: " + std::string(layout.title),
                  .group = "View",
                  .icon = icons::kLayout,
                  .keys = {{static_cast<Key>(digit++), kCtrl}},
                  .run = [this, make = layout.make] {
                    const std::string method =
                        session_ == nullptr ? Config().run.method : session_->config.run.method;
                    after_frame_ = [this, make, method] { set_layout(make(method)); };
                  }});
}

}  // namespace stillpoint
