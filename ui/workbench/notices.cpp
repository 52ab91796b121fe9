// What the workbench says by itself: a sequence being opened, an error; and what it keeps of the session for
// it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <utility>

#include "core/inspect/frame_view.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"
#include "ui/theme/theme.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {
namespace {

constexpr ImGuiWindowFlags kNoticeFlags =
    ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
    ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_AlwaysAutoResize;
// Time to read two sentences; and between pictures of what turns.
constexpr double kErrorShownSeconds = 20.0, kTurnSeconds = 0.12;

/// A sequence's name as a part of a file's.
std::string file_name_of(std::string title) {
  std::replace_if(
      title.begin(), title.end(), [](char c) { return c == '/' || c == ':' || c == ' '; }, '_');
  return title;
}

/// A card over the panels. @param pivot which point of it lies at `at`, as shares
bool begin_notice(const UiFrame& frame, const char* name, ImVec2 at, ImVec2 pivot, Rgb edge) {
  ImGui::SetNextWindowPos(at, ImGuiCond_Always, pivot);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {16.0F * frame.scale, 12.0F * frame.scale});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, std::max(1.0F, std::round(frame.scale)));
  ImGui::PushStyleColor(ImGuiCol_Border, to_vec4(edge));
  ImGui::PushStyleColor(ImGuiCol_WindowBg, to_vec4(frame.theme.panel));
  const bool visible = ImGui::Begin(name, nullptr, kNoticeFlags);
  ImGui::PopStyleColor(2);
  ImGui::PopStyleVar(2);
  return visible;
}

}  // namespace

std::string Workbench::pace_text() const {
  std::string text =
      fmt::format("{:.1f} of {:.0f} fps", pace_->shown / std::max(pace_->seconds, 1e-3), speed_);
  if (pace_->dropped > 0)
    text += fmt::format(", {} frame{} not shown", pace_->dropped, pace_->dropped == 1 ? "" : "s");
  return text;
}

/// Counts what is shown while playing, and the frames that went by between two pictures.
void Workbench::follow_play() {
  constexpr int kWorthTelling = 10;  // frames shown
  if (session_ == nullptr || !session_->playing) {
    if (!pace_) return;
    last_dropped_ = pace_->dropped;
    // Frames that nobody saw are told even where that was soon over.
    if (session_ != nullptr && (pace_->dropped > 0 || (pace_->shown >= kWorthTelling &&
                                                       pace_->shown < 0.9 * speed_ * pace_->seconds)))
      say(fmt::format("played frames {} to {}: {}", pace_->begun_at, session_->current->index, pace_text()));
    pace_.reset();
    return;
  }
  const int here = session_->current->index;
  if (!pace_) pace_ = Pace{.begun_at = here, .begun_s = time_s_};
  // Back is no drop: play goes round in a range.
  if (last_shown_ >= 0 && here > last_shown_) {
    ++pace_->shown;
    pace_->dropped += here - last_shown_ - 1;
  } else if (here != last_shown_) {
    ++pace_->shown;
  }
  pace_->seconds = time_s_ - pace_->begun_s;
}

void Workbench::follow_session() {
  follow_play();
  if (session_ == nullptr) {
    last_shown_ = -1;
    return;
  }
  last_shown_ = session_->current->index;
  if (session_->message == last_trouble_) return;
  last_trouble_ = session_->message;
  if (!last_trouble_.empty()) say(last_trouble_, true);
}

void Workbench::draw_opening() {
  if (opening_.empty()) return;
  const UiFrame& frame = *frame_;
  frame_->redraw_after_s = std::min(frame_->redraw_after_s, kTurnSeconds);
  // Below what the start page says, in the middle of panels.
  const float height = session_ == nullptr ? 0.8F : 0.46F;
  if (begin_notice(frame, "##opening", {0.5F * frame.size.x, height * frame.size.y}, {0.5F, 0.5F},
                   mix(frame.theme.border, frame.theme.accent, 0.6F))) {
    // A dot goes round while the interface lives.
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float radius = 9.0F * frame.scale, line = ImGui::GetFontSize();
    const ImVec2 centre{corner.x + radius, corner.y + line};
    const auto angle = static_cast<float>(std::fmod(frame.time_s / (8.0 * kTurnSeconds), 1.0) * 6.2831853);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddCircle(centre, radius, to_u32(frame.theme.border), 0, 2.0F * frame.scale);
    list.PathArcTo(centre, radius, angle, angle + 1.6F);
    list.PathStroke(to_u32(frame.theme.accent), 0, 2.5F * frame.scale);
    ImGui::Dummy({2.6F * radius, 2.0F * line});
    ImGui::SameLine();
    ImGui::BeginGroup();
    ImGui::PushFont(frame.fonts.strong);
    ImGui::TextUnformatted("Opening…");
    ImGui::PopFont();
    ImGui::TextColored(to_vec4(frame.theme.text_dim), "%s", opening_.c_str());
    ImGui::EndGroup();
  }
  ImGui::End();
}

void Workbench::draw_hand_on_dialog() {
  if (session_ == nullptr) return;
  const auto& span = session_->debug.span;
  const int frames = span ? std::min(span->last + 1, session_->processed) : session_->processed;
  const std::string what = fmt::format(
      "A new folder for {} frames, their run and all marks; `stillpoint view` opens it anywhere", frames);
  if (ask_for_path(hand_on_dialog_, "Hand this session on", what.c_str(), "Write"))
    ask(request::ExportSession{hand_on_dialog_.path});
}

void Workbench::draw_save_dialog() {
  if (offered_) {
    saving_ = std::exchange(offered_, std::nullopt);
    save_dialog_ = {.open = true, .opened_now = true};
    const std::string title = session_ == nullptr ? "" : file_name_of(session_->title) + "_";
    const std::string path = (std::filesystem::current_path() / (title + saving_->name)).string();
    path.copy(save_dialog_.path, sizeof save_dialog_.path - 1);
  }
  if (!save_dialog_.open) return;
  std::error_code none;
  const bool there = std::filesystem::exists(save_dialog_.path, none);
  const std::string what = there ? "This file exists and will be replaced"
                                 : fmt::format("A file that ends in {}", saving_->endings);
  if (!ask_for_path(save_dialog_, "Save", what.c_str(), "Save")) return;
  try {
    saving_->write(save_dialog_.path);
    say(fmt::format("written to {}", save_dialog_.path));
  } catch (const std::exception& error) {
    say(error.what(), true);
  }
}

void Workbench::draw_exporting() {
  if (session_ == nullptr || !session_->debug.exporting) return;
  const ExportView& view = *session_->debug.exporting;
  const UiFrame& frame = *frame_;
  const float margin = 14.0F * frame.scale;
  if (begin_notice(frame, "##exporting", {margin, frame.size.y - 25.0F * frame.scale - margin}, {0.0F, 1.0F},
                   mix(frame.theme.border, frame.theme.accent, 0.6F))) {
    ImGui::PushFont(frame.fonts.strong);
    ImGui::TextUnformatted(view.what == "run"     ? "Running over what was written…"
                           : view.what == "masks" ? "Carrying outlines…"
                                                  : "Writing frames…");
    ImGui::PopFont();
    ImGui::TextColored(to_vec4(frame.theme.text_dim), "%s", view.folder.c_str());
    const float share =
        view.total > 0 ? static_cast<float>(view.done) / static_cast<float>(view.total) : 0.0F;
    ImGui::ProgressBar(share, {260.0F * frame.scale, 0.0F},
                       fmt::format("{} of {}", view.done, view.total).c_str());
    ImGui::SameLine();
    if (ImGui::Button("Stop")) ask(request::StopExport{});
  }
  ImGui::End();
}

void Workbench::draw_error() {
  if (!error_open_) return;
  const double left_s = said_s_ + kErrorShownSeconds - time_s_;
  if (left_s <= 0.0) {
    error_open_ = false;
    return;
  }
  const UiFrame& frame = *frame_;
  frame_->redraw_after_s = std::min(frame_->redraw_after_s, left_s);
  const Rgb warning = role_colour(Role::kWarning, frame.theme.name);
  const float margin = 14.0F * frame.scale,
              width = std::min(440.0F * frame.scale, frame.size.x - 6.0F * margin);
  if (begin_notice(frame, "##error", {frame.size.x - margin, frame.size.y - 25.0F * frame.scale - margin},
                   {1.0F, 1.0F}, warning)) {
    ImGui::PushFont(frame.fonts.strong);
    ImGui::TextColored(to_vec4(warning), "%s", icons::kWarning);
    ImGui::PopFont();
    ImGui::SameLine();
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + width - 60.0F * frame.scale);
    ImGui::TextUnformatted(message_.c_str());
    ImGui::PopTextWrapPos();
    if (ImGui::Button("Put away")) error_open_ = false;
    if (session_ != nullptr && find_panel("log") != nullptr &&
        (!contains(layout_, "log") || is_behind("log"))) {
      ImGui::SameLine();
      if (ImGui::Button("Show the log")) {
        error_open_ = false;
        actions_.run("panel.log");
      }
    }
  }
  ImGui::End();
}

}  // namespace stillpoint
