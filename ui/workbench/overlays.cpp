// What lies over the workbench: sheet of keys, questions for a path, the question what to open.
#include <fmt/format.h>

#include <algorithm>

#include "ui/panels/panel_kit.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {

bool begin_overlay(const UiFrame& frame, const char* name, ImVec2 size, float top_share) {
  size.x = std::min(size.x, frame.size.x - 20.0F);
  size.y = std::min(size.y, (1.0F - top_share) * frame.size.y - 10.0F);
  ImGui::SetNextWindowPos({0.5F * (frame.size.x - size.x), top_share * frame.size.y});
  ImGui::SetNextWindowSize(size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {14.0F * frame.scale, 12.0F * frame.scale});
  ImGui::PushStyleColor(ImGuiCol_Border, to_vec4(mix(frame.theme.border, frame.theme.accent, 0.5F)));
  constexpr ImGuiWindowFlags kFlags =
      ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings;
  const bool visible = ImGui::Begin(name, nullptr, kFlags);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar();
  return visible;
}

void Workbench::draw_shortcuts() {
  if (!shortcuts_open_) return;
  const float scale = frame_->scale;
  ImGui::SetNextWindowFocus();
  if (begin_overlay(*frame_, "##keys", {920.0F * scale, 700.0F * scale}, 0.06F)) {
    ImGui::PushFont(frame_->fonts.heading);
    ImGui::TextUnformatted("Keys");
    ImGui::PopFont();
    text_in_lines(
        "On images: wheel zooms, drag pans, double click fits. On plots: wheel zooms, right drag pans, a "
        "click "
        "goes to the frame there.");
    // What does not fit is scrolled to.
    ImGui::BeginChild("list");
    draw_shortcut_list(ImGui::GetContentRegionAvail().x > 760.0F * scale ? 2 : 1);
    ImGui::EndChild();
  }
  ImGui::End();
  if (is_key_pressed(Key::kEscape) || ImGui::IsMouseClicked(0)) shortcuts_open_ = false;
}

void Workbench::draw_shortcut_list(int columns) const {
  std::vector<const Action*> lines;  // null before the first action of each group
  for (const std::string& group : actions_.groups()) {
    const std::size_t before = lines.size();
    for (const Action& action : actions_.all()) {
      if (action.group != group || action.keys.empty()) continue;
      if (lines.size() == before) lines.push_back(nullptr);
      lines.push_back(&action);
    }
  }
  const auto wanted = static_cast<std::size_t>(columns);
  const std::size_t rows = (lines.size() + wanted - 1) / wanted;
  if (!ImGui::BeginTable("keys", 2 * columns, ImGuiTableFlags_SizingStretchProp)) return;
  for (int i = 0; i < 2 * columns; ++i)
    ImGui::TableSetupColumn(fmt::format("{}", i).c_str(), ImGuiTableColumnFlags_WidthStretch,
                            i % 2 == 0 ? 1.0F : 0.4F);
  for (std::size_t row = 0; row < rows; ++row) {
    ImGui::TableNextRow();
    for (std::size_t place = row; place < row + rows * wanted; place += rows) {
      ImGui::TableNextColumn();
      const bool there = place < lines.size();
      if (there && lines[place] == nullptr)
        ImGui::TextDisabled("%s", lines[place + 1]->group.c_str());
      else if (there)
        text_in_room("    " + lines[place]->title, frame_->theme.text);
      ImGui::TableNextColumn();
      if (!there || lines[place] == nullptr) continue;
      ImGui::PushFont(frame_->fonts.mono);
      ImGui::TextColored(to_vec4(frame_->theme.accent), "%s", key_text(*lines[place]).c_str());
      ImGui::PopFont();
    }
  }
  ImGui::EndTable();
}

bool Workbench::ask_for_path(PathDialog& dialog, const char* title, const char* what, const char* button) {
  if (!dialog.open) return false;
  const float scale = frame_->scale;
  if (dialog.opened_now) ImGui::SetNextWindowFocus();
  bool wanted = false;
  if (begin_overlay(*frame_, title, {640.0F * scale, 142.0F * scale}, 0.2F)) {
    ImGui::PushFont(frame_->fonts.strong);
    ImGui::TextUnformatted(title);
    ImGui::PopFont();
    ImGui::TextDisabled("%s", what);
    if (dialog.opened_now) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(-1.0F);
    wanted =
        ImGui::InputText("##path", dialog.path, sizeof dialog.path, ImGuiInputTextFlags_EnterReturnsTrue);
    wanted = ImGui::Button(button) || wanted;
    ImGui::SameLine();
    if (ImGui::Button("Cancel") || is_key_pressed(Key::kEscape)) dialog.open = false;
  }
  dialog.opened_now = false;
  ImGui::End();
  if (!wanted || dialog.path[0] == '\0') return false;
  dialog.open = false;
  return true;
}

void Workbench::draw_open_dialog() {
  const auto chosen = open_dialog_.draw(*frame_, recent_);
  if (!chosen) return;
  // What was open before, and is not to be read otherwise, comes back as it was left.
  const bool as_left = chosen->reading.empty() && chosen->method.empty();
  after_frame_ = [this, as_left, as = *chosen] {
    if (as_left || !host_.open_as)
      host_.open(as.where);
    else
      host_.open_as(as);
  };
}

}  // namespace stillpoint
