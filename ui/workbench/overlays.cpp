// What lies over the workbench: command palette, sheet of keys, the question what to open.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>

#include "ui/panels/panel_kit.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/theme/icons.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {
namespace {

constexpr ImGuiWindowFlags kOverlayFlags =
    ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings;

/// An overlay centred in x, its top at a share of the height.
bool begin_overlay(const UiFrame& frame, const char* name, ImVec2 size, float top_share) {
  size.x = std::min(size.x, frame.size.x - 20.0F);
  size.y = std::min(size.y, (1.0F - top_share) * frame.size.y - 10.0F);
  ImGui::SetNextWindowPos({0.5F * (frame.size.x - size.x), top_share * frame.size.y});
  ImGui::SetNextWindowSize(size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {14.0F * frame.scale, 12.0F * frame.scale});
  ImGui::PushStyleColor(ImGuiCol_Border, to_vec4(mix(frame.theme.border, frame.theme.accent, 0.5F)));
  const bool visible = ImGui::Begin(name, nullptr, kOverlayFlags);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar();
  return visible;
}

std::optional<int> as_frame(const char* query, int frame_count) {
  int frame = 0;
  const char* end = query + std::strlen(query);
  const auto [rest, error] = std::from_chars(query, end, frame);
  if (error != std::errc() || rest != end || frame < 0 || frame >= frame_count) return std::nullopt;
  return frame;
}

/// A row of the palette: icon, title, key at the right. @returns whether it was clicked
bool palette_row(const UiFrame& frame, const char* icon, const std::string& title, const std::string& key,
                 bool chosen) {
  ImGui::PushID(title.c_str());
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  const bool clicked = ImGui::Selectable("##row", chosen, 0, {width, 1.35F * ImGui::GetFontSize()});
  const float y = at.y + 0.18F * ImGui::GetFontSize();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddText({at.x + 4.0F * frame.scale, y}, to_u32(frame.theme.text_dim), icon);
  list.AddText({at.x + 30.0F * frame.scale, y}, to_u32(frame.theme.text), title.c_str());
  ImGui::PushFont(frame.fonts.mono);
  list.AddText({at.x + width - ImGui::CalcTextSize(key.c_str()).x - 4.0F * frame.scale, y},
               to_u32(frame.theme.text_dim), key.c_str());
  ImGui::PopFont();
  if (chosen) ImGui::SetScrollHereY();
  ImGui::PopID();
  return clicked;
}

}  // namespace

void Workbench::draw_palette() {
  if (!palette_.open) return;
  const float scale = frame_->scale, height = 420.0F * scale;
  if (palette_.opened_now) ImGui::SetNextWindowFocus();
  if (begin_overlay(*frame_, "##palette", {620.0F * scale, height}, 0.12F)) {
    if (palette_.opened_now) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(-1.0F);
    if (ImGui::InputTextWithHint("##query", "What to do, or a frame's number", palette_.query,
                                 sizeof palette_.query))
      palette_.chosen = 0;
    draw_palette_list();
  }
  const bool left = !palette_.opened_now && !ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows);
  if (left || is_key_pressed(Key::kEscape)) palette_.open = false;
  palette_.opened_now = false;
  ImGui::End();
}

void Workbench::draw_palette_list() {
  const auto actions = actions_.matching(palette_.query);
  const auto frame =
      session_ != nullptr && can_go() ? as_frame(palette_.query, session_->frame_count) : std::nullopt;
  const int rows = static_cast<int>(actions.size()) + (frame ? 1 : 0);
  if (is_key_pressed(Key::kDown, true)) ++palette_.chosen;
  if (is_key_pressed(Key::kUp, true)) --palette_.chosen;
  palette_.chosen = rows == 0 ? 0 : (palette_.chosen + rows) % rows;
  const bool entered = is_key_pressed(Key::kEnter) || is_key_pressed(Key::kKeypadEnter);
  std::function<void()> run;
  ImGui::BeginChild("rows");
  int row = 0;
  if (frame) {
    const bool chosen = palette_.chosen == row++;
    if (palette_row(*frame_, icons::kChevronRight, fmt::format("Go to frame {}", *frame), "", chosen) ||
        (chosen && entered))
      run = [this, to = *frame] { go_to(to); };
  }
  for (const Action* action : actions) {
    const bool chosen = palette_.chosen == row++;
    if (palette_row(*frame_, action->icon.c_str(), action->title, key_text(*action), chosen) ||
        (chosen && entered))
      run = action->run;
  }
  if (rows == 0) ImGui::TextDisabled("Nothing has such a name.");
  ImGui::EndChild();
  if (!run) return;
  palette_.open = false;
  run();
}

void Workbench::draw_shortcuts() {
  if (!shortcuts_open_) return;
  const float scale = frame_->scale;
  ImGui::SetNextWindowFocus();
  if (begin_overlay(*frame_, "##keys", {920.0F * scale, 640.0F * scale}, 0.08F)) {
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
