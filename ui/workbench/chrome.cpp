// What frames the workbench's tiles: menus, toolbar, status bar.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/inspect/frame_verdict.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/session/data_sources.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"
#include "ui/theme/theme.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {
namespace {

constexpr float kVerdictHeight = 22.0F;                  // design px
constexpr double kSpeeds[] = {1, 2, 5, 10, 15, 30, 60};  // frames a second

/// What a status is called and how it is coloured.
struct StatusLook {
  std::string text;
  Rgb colour;
};

StatusLook status_look(const SessionView& session, const Theme& theme) {
  const FrameRecord* record = session.current->record;
  if (record == nullptr) return {"not processed yet", theme.text_dim};
  const bool lost = record->status == FrameStatus::lost || record->status == FrameStatus::unreadable;
  return {std::string(to_string(record->status)),
          role_colour(lost ? Role::kRemoved : Role::kKept, theme.name)};
}

/// What is wrong with the session or the frame shown; empty when all is well.
std::string trouble_of(const SessionView& session) {
  if (!session.message.empty()) return session.message;
  const FrameRecord* record = session.current->record;
  return record != nullptr ? record->note : session.current->frame.problem;
}

void tooltip(const Action& action) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  const std::string key = key_text(action);
  ImGui::SetTooltip("%s%s%s%s", action.title.c_str(), key.empty() ? "" : "  (", key.c_str(),
                    key.empty() ? "" : ")");
}

}  // namespace

void Workbench::draw_menu_bar() {
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {8.0F * frame_->scale, 8.0F * frame_->scale});
  if (ImGui::BeginMenuBar()) {
    draw_menu_row();
    ImGui::EndMenuBar();
  }
  ImGui::PopStyleVar();
}

void Workbench::draw_menu_row() {
  ImGui::SetCursorPosX(12.0F * frame_->scale);
  ImGui::PushFont(frame_->fonts.strong);
  ImGui::TextColored(to_vec4(frame_->theme.accent), "%s", icons::kTarget);
  ImGui::SameLine(0.0F, 6.0F * frame_->scale);
  ImGui::TextUnformatted("Stillpoint");
  ImGui::PopFont();
  ImGui::SameLine(0.0F, 14.0F * frame_->scale);
  for (const std::string& group : actions_.groups()) {
    if (!ImGui::BeginMenu(group.c_str())) continue;
    for (const Action& action : actions_.all()) {
      if (action.group != group) continue;
      const bool checked = action.checked && action.checked();
      const std::string title =
          group == "Panels" ? action.title.substr(action.title.find(':') + 2) : action.title;
      if (ImGui::MenuItem(title.c_str(), key_text(action).c_str(), checked, is_enabled(action))) action.run();
    }
    if (group == "File" && host_.open && !recent_.empty() && ImGui::BeginMenu("Recent")) {
      for (const std::string& path : recent_)
        if (ImGui::MenuItem(path.c_str())) after_frame_ = [this, path] { host_.open(path); };
      ImGui::EndMenu();
    }
    ImGui::EndMenu();
  }
  if (session_ == nullptr) return;
  const std::string title = session_->title;
  ImGui::PushFont(frame_->fonts.small);
  const float width = ImGui::CalcTextSize(title.c_str()).x;
  const float left = ImGui::GetCursorScreenPos().x, right = frame_->size.x - 14.0F * frame_->scale;
  const float x = std::max(left + 20.0F * frame_->scale, right - width);
  draw_clipped_text({x, ImGui::GetCursorScreenPos().y + 4.0F * frame_->scale}, title, right - x,
                    to_u32(frame_->theme.text_dim));
  ImGui::PopFont();
}

bool Workbench::action_button(const char* name) {
  const Action& action = *actions_.find(name);
  const bool playing = action.name == "play_pause" && session_->playing;
  const float side = 28.0F * frame_->scale;
  const bool enabled = is_enabled(action);
  // Images are not for pressing: there, buttons look as they do when they can be pressed.
  ImGui::BeginDisabled(!enabled && static_cast<bool>(host_.go_to_frame));
  const bool pressed =
      ImGui::Button(playing ? icons::kPause : action.icon.c_str(), {side * 1.15F, side}) && enabled;
  ImGui::EndDisabled();
  tooltip(action);
  if (pressed) action.run();
  return pressed;
}

void Workbench::draw_toolbar() {
  const float margin = 8.0F * frame_->scale;
  ImGui::SetCursorScreenPos({margin, ImGui::GetCursorScreenPos().y + 1.0F * frame_->scale});
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {4.0F * frame_->scale, 6.0F * frame_->scale});
  // On the light theme's background a raised surface would not be seen.
  const Theme& theme = frame_->theme;
  const Rgb surface = theme.name == ThemeName::kLight ? theme.panel : theme.raised;
  ImGui::PushStyleColor(ImGuiCol_Button, to_vec4(surface));
  ImGui::PushStyleColor(ImGuiCol_FrameBg, to_vec4(surface));
  draw_transport();
  ImGui::SameLine(0.0F, 14.0F * frame_->scale);
  ImGui::PushFont(frame_->fonts.mono);
  ImGui::AlignTextToFramePadding();
  const std::string last = std::to_string(session_->frame_count - 1);
  ImGui::Text("%*d", static_cast<int>(last.size()), session_->current->index);
  ImGui::SameLine(0.0F, 0.0F);
  ImGui::TextDisabled(" / %s", last.c_str());
  ImGui::PopFont();
  ImGui::SameLine(0.0F, 14.0F * frame_->scale);
  const float speed_width = 92.0F * frame_->scale;
  draw_frame_slider(ImGui::GetContentRegionAvail().x - speed_width - 2.0F * margin);
  ImGui::SameLine(0.0F, margin);
  ImGui::SetNextItemWidth(speed_width);
  draw_speed();
  ImGui::PopStyleColor(2);
  ImGui::PopStyleVar();
  ImGui::SetCursorScreenPos({0.0F, ImGui::GetCursorScreenPos().y});
}

void Workbench::draw_transport() {
  for (const char* name : {"first", "step_back", "play_pause", "step", "last_processed"}) {
    action_button(name);
    ImGui::SameLine();
  }
  ImGui::SameLine(0.0F, 12.0F * frame_->scale);
  for (const char* name : {"previous_keyframe", "next_keyframe", "next_lost"}) {
    action_button(name);
    ImGui::SameLine();
  }
}

void Workbench::draw_frame_slider(float width) {
  const float height = 28.0F * frame_->scale;
  const ImVec2 low = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("frames", {std::max(width, 10.0F), height});
  const bool active = ImGui::IsItemActive(), hovered = ImGui::IsItemHovered();
  const float most = static_cast<float>(std::max(1, session_->frame_count - 1)),
              radius = 6.0F * frame_->scale;
  const float left = low.x + radius, span = std::max(1.0F, width - 2.0F * radius),
              middle = low.y + 0.5F * height;
  const auto x_of = [&](int frame) { return left + span * static_cast<float>(frame) / most; };
  const auto frame_at = [&](float x) {
    return static_cast<int>(std::lround(std::clamp((x - left) / span, 0.0F, 1.0F) * most));
  };

  const Theme& theme = frame_->theme;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float half = 3.0F * frame_->scale;
  list.AddRectFilled({left, middle - half}, {left + span, middle + half},
                     to_u32(mix(theme.raised, theme.text_dim, 0.25F)), half);
  if (session_->processed > 0)
    list.AddRectFilled({left, middle - half}, {x_of(session_->processed - 1), middle + half},
                       to_u32(mix(theme.raised, theme.accent, 0.45F)), half);
  const ImU32 keyframe = to_u32(mix(theme.accent, theme.text, 0.3F)),
              lost = to_u32(role_colour(Role::kRemoved, theme.name));
  for (const FrameOutline& frame : session_->run->records.outlines()) {
    const float x = x_of(frame.index);
    if (frame.keyframe)
      list.AddLine({x, middle - 2.6F * half}, {x, middle - 1.3F * half}, keyframe, frame_->scale);
    if (is_lost(frame.status))
      list.AddRectFilled({x - frame_->scale, middle - half}, {x + frame_->scale, middle + 2.4F * half}, lost);
  }
  const ImVec2 handle{x_of(session_->current->index), middle};
  list.AddCircleFilled(handle, radius, to_u32(hovered || active ? theme.text : theme.accent));
  list.AddCircle(handle, radius, to_u32(theme.background), 0, 1.5F * frame_->scale);

  const int pointed = frame_at(ImGui::GetIO().MousePos.x);
  if (hovered || active) ImGui::SetTooltip("frame %d", pointed);
  if (active && pointed != session_->current->index) go_to(pointed);
}

void Workbench::draw_speed() {
  if (!ImGui::BeginCombo("##speed", fmt::format("{:.0f} fps", speed_).c_str())) return;
  for (const double speed : kSpeeds) {
    if (!ImGui::Selectable(fmt::format("{:.0f} fps", speed).c_str(), speed == speed_)) continue;
    speed_ = speed;
    if (host_.speed) host_.speed(speed);
  }
  ImGui::EndCombo();
}

void Workbench::draw_verdict() {
  const Theme& theme = frame_->theme;
  const float scale = frame_->scale, height = std::round(kVerdictHeight * scale);
  const ImVec2 low = ImGui::GetCursorScreenPos();
  ImGui::PushFont(frame_->fonts.small);
  const float y = low.y + 0.5F * (height - ImGui::GetFontSize()) - scale,
              right = frame_->size.x - 12.0F * scale;
  float x = 12.0F * scale;
  const auto put = [&](const std::string& text, Rgb colour) {
    if (x >= right) return;
    draw_clipped_text({x, y}, text, right - x, to_u32(colour));
    x += ImGui::CalcTextSize(text.c_str()).x + 16.0F * scale;
  };
  if (const auto row = record_of(*session_, session_->current->index)) {
    const VerdictKey key{session_->run.get(), session_->revision, session_->run->records.size(), *row};
    if (!(key == verdict_key_)) {  // it asks all frames what is usual
      verdict_ = frame_verdict(*session_->run, *row, hurt_frames(session_->debug));
      verdict_key_ = key;
    }
    const FrameVerdict& verdict = verdict_;
    const Rgb bad = role_colour(Role::kRemoved, theme.name), good = role_colour(Role::kKept, theme.name);
    for (const FrameVerdict::Part& part : verdict.parts) {
      if (x < right)
        ImGui::GetWindowDrawList()->AddCircleFilled({x + 3.0F * scale, y + 0.5F * ImGui::GetFontSize()},
                                                    3.0F * scale,
                                                    to_u32(part.tone == Tone::bad    ? bad
                                                           : part.tone == Tone::good ? good
                                                                                     : theme.text_dim));
      x += 11.0F * scale;
      put(part.text, theme.text);
    }
    put(verdict.sentence, verdict.bad ? role_colour(Role::kWarning, theme.name) : theme.text_dim);
  } else {
    put("This frame has not been processed yet.", theme.text_dim);
  }
  // What is read here while playing is not of every frame that went by.
  if (pace_ && pace_->dropped > 0)
    put(fmt::format("{} frame{} passed over unseen", pace_->dropped, pace_->dropped == 1 ? "" : "s"),
        role_colour(Role::kWarning, theme.name));
  ImGui::PopFont();
  ImGui::SetCursorScreenPos({0.0F, low.y + height});
}

void Workbench::draw_status_bar(float height) {
  const Theme& theme = frame_->theme;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float top = frame_->size.y - height, scale = frame_->scale;
  list.AddRectFilled({0, top}, frame_->size, to_u32(mix(theme.background, theme.raised, 0.35F)));
  list.AddLine({0, top}, {frame_->size.x, top}, to_u32(theme.border));
  ImGui::PushFont(frame_->fonts.small);
  float x = 12.0F * scale;
  const float y = top + 0.5F * (height - ImGui::GetFontSize());
  const auto put = [&](const std::string& text, Rgb colour) {
    list.AddText({x, y}, to_u32(colour), text.c_str());
    x += ImGui::CalcTextSize(text.c_str()).x + 18.0F * scale;
  };
  if (session_ != nullptr) {
    const StatusLook status = status_look(*session_, theme);
    list.AddCircleFilled({x + 3.0F * scale, top + 0.5F * height}, 4.0F * scale, to_u32(status.colour));
    x += 13.0F * scale;
    put(fmt::format("frame {}  {}", session_->current->index, status.text), theme.text);
    put(run_words(*session_), theme.text_dim);
    if (const FrameRecord* record = session_->current->record; record != nullptr && record->measured.features)
      put(fmt::format("{} of {} features kept, {} inliers", record->features_kept, record->features_found,
                      record->inliers),
          theme.text_dim);
    put(fmt::format("{} of {} frames processed", session_->processed, session_->frame_count), theme.text_dim);
    if (pace_ && pace_->shown > 0)
      put(pace_text(), pace_->dropped > 0 ? role_colour(Role::kWarning, theme.name) : theme.text_dim);
    if (session_->busy && !session_->playing) put("working…", theme.accent);
  }
  // A key that was struck is answered, whatever else there is to say.
  const std::string trouble = session_ == nullptr || refused_ ? "" : trouble_of(*session_);
  const std::string message = trouble.empty() ? message_ : trouble;
  const bool error = !trouble.empty() || message_is_error_;
  if (!message.empty()) {
    const float right = frame_->size.x - 12.0F * scale;
    const float from = std::max(x, right - ImGui::CalcTextSize(message.c_str()).x);
    draw_clipped_text({from, y}, message, right - from,
                      to_u32(error ? role_colour(Role::kWarning, theme.name) : theme.text));
  }
  ImGui::PopFont();
}

}  // namespace stillpoint
