// Headings of tiles, and tiles that share a place.
#include <algorithm>

#include "ui/panels/panel_kit.hpp"
#include "ui/panels/run_look.hpp"
#include "ui/panels/run_pictures.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {

PlacedLayout Workbench::placed_tiles(const LayoutRect& area) const {
  const float scale = frame_->scale;
  PlacedLayout placed = arrange(layout_, area, std::round(kTileGap * scale), [&](const std::string& name) {
    const Panel* panel = find_panel(name);
    const PanelSize least = panel == nullptr ? PanelSize{} : panel->least();
    return TileSize{least.width * scale, least.height * scale};
  });
  // Of several in one place the one brought to the front last is seen.
  for (PlacedPanel& place : placed.panels)
    for (const std::string& front : fronts_)
      if (std::find(place.tabs.begin(), place.tabs.end(), front) != place.tabs.end()) place.panel = front;
  return placed;
}

void Workbench::bring_to_front(const std::string& panel) {
  std::erase(fronts_, panel);
  fronts_.push_back(panel);
}

bool Workbench::is_behind(const std::string& panel) const {
  return std::any_of(places_.begin(), places_.end(), [&](const PlacedPanel& place) {
    return place.panel != panel && std::find(place.tabs.begin(), place.tabs.end(), panel) != place.tabs.end();
  });
}

void Workbench::next_tab() {
  for (const PlacedPanel& place : places_) {
    if (place.panel != hovered_panel_ || place.tabs.empty()) continue;
    const auto at = std::find(place.tabs.begin(), place.tabs.end(), place.panel);
    bring_to_front(at == place.tabs.end() || at + 1 == place.tabs.end() ? place.tabs.front() : *(at + 1));
    return;
  }
}

void Workbench::draw_tile_heading(Panel& panel, const PlacedPanel& tile, float height) {
  const LayoutRect& rect = tile.rect;
  const float button = height - 4.0F * frame_->scale, margin = 9.0F * frame_->scale;
  const float buttons = 2.0F * button + 6.0F * frame_->scale;
  const ImVec2 badge{rect.x + rect.width - buttons - 4.0F * frame_->scale, rect.y + 4.0F * frame_->scale};
  const SessionView& session = view_of(panel.name());
  if (panel.previews() && shows_preview(session))
    draw_badge(*frame_, badge, "Preview", role_colour(Role::kWarning, frame_->theme.name));
  else if (is_by_runs(*frame_, session, panel))
    if (const auto flipped = runs_.flipped(session))
      draw_badge(*frame_, badge, shortened(flipped->name, 18), run_colour(*flipped, frame_->theme.name));
  if (tile.tabs.empty()) {
    ImGui::PushFont(frame_->fonts.strong);
    draw_clipped_text({rect.x + margin, rect.y + 0.5F * (height - ImGui::GetFontSize())}, panel.title(),
                      rect.width - margin - buttons, to_u32(frame_->theme.text));
    ImGui::PopFont();
  } else {
    draw_tabs(tile, height, rect.width - margin - buttons);
  }
  ImGui::PushStyleColor(ImGuiCol_Button, ImVec4{0, 0, 0, 0});
  ImGui::PushStyleColor(ImGuiCol_Text, to_vec4(frame_->theme.text_dim));
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {0, 0});
  ImGui::SetCursorScreenPos({rect.x + rect.width - buttons, rect.y + 2.0F * frame_->scale});
  const bool maximised = maximised_ == panel.name();
  if (ImGui::Button(maximised ? icons::kRestore : icons::kMaximise, {button, button}))
    after_frame_ = [this, name = maximised ? std::string() : panel.name()] { maximised_ = name; };
  ImGui::SetCursorScreenPos(
      {rect.x + rect.width - buttons + button + 2.0F * frame_->scale, rect.y + 2.0F * frame_->scale});
  if (ImGui::Button(icons::kBars, {button, button})) ImGui::OpenPopup("tile menu");
  ImGui::PopStyleVar();
  ImGui::PopStyleColor(2);
  draw_tile_menu(panel.name());
}

void Workbench::draw_tile_menu(const std::string& name) {
  if (!ImGui::BeginPopup("tile menu")) return;
  const bool maximised = maximised_ == name;
  if (ImGui::MenuItem(maximised ? "Restore" : "Maximise", "M"))
    after_frame_ = [this, wanted = maximised ? std::string() : name] { maximised_ = wanted; };
  if (ImGui::MenuItem("Hide", nullptr, false, maximised_.empty() && !layout_.is_panel()))
    after_frame_ = [this, name] { remove_panel(layout_, name); };
  ImGui::Separator();
  if (ImGui::BeginMenu("Show here", maximised_.empty())) {
    for (const auto& panel : panels_)
      if (ImGui::MenuItem(panel->title().c_str(), contains(layout_, panel->name()) ? "swap" : "",
                          panel->name() == name))
        after_frame_ = [this, name, wanted = panel->name()] {
          replace_panel(layout_, name, wanted);
          bring_to_front(wanted);
        };
    ImGui::EndMenu();
  }
  ImGui::EndPopup();
}

void Workbench::draw_tabs(const PlacedPanel& tile, float height, float width) {
  const float scale = frame_->scale, pad = 8.0F * scale, more = height;
  const auto title_of = [&](const std::string& name) {
    const Panel* panel = find_panel(name);
    return panel == nullptr ? name : panel->title();
  };
  ImGui::PushFont(frame_->fonts.strong);
  const auto width_of = [&](const std::string& title) {
    return ImGui::CalcTextSize(title.c_str()).x + 2.0F * pad;
  };
  // The one that is seen always has its name; of the others as many as there is room for.
  std::vector<std::string> shown;
  float used = 0.0F;
  const auto take = [&](const std::string& name, float spare) {
    const float needed = width_of(title_of(name));
    if (used + needed > width - spare) return false;
    used += needed;
    shown.push_back(name);
    return true;
  };
  if (!take(tile.panel, more)) shown.push_back(tile.panel), used = width - more;
  for (std::size_t i = 0; i < tile.tabs.size(); ++i)
    if (tile.tabs[i] != tile.panel)
      (void)take(tile.tabs[i], shown.size() + 1 < tile.tabs.size() ? more : 0.0F);
  const bool hides = shown.size() < tile.tabs.size();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  float x = tile.rect.x + 1.0F * scale;
  for (const std::string& name : tile.tabs) {
    if (std::find(shown.begin(), shown.end(), name) == shown.end()) continue;
    const std::string title = title_of(name);
    const bool front = name == tile.panel;
    const float wide = std::min(width_of(title), width - (hides ? more : 0.0F));
    ImGui::SetCursorScreenPos({x, tile.rect.y});
    if (ImGui::InvisibleButton(name.c_str(), {wide, height}) && !front)
      after_frame_ = [this, name] { bring_to_front(name); };
    const bool hovered = ImGui::IsItemHovered();
    if (front)
      list.AddRectFilled({x + pad, tile.rect.y + height - 2.0F * scale},
                         {x + wide - pad, tile.rect.y + height}, to_u32(frame_->theme.accent));
    draw_clipped_text({x + pad, tile.rect.y + 0.5F * (height - ImGui::GetFontSize())}, title,
                      wide - 2.0F * pad,
                      to_u32(front || hovered ? frame_->theme.text : frame_->theme.text_dim));
    x += wide;
  }
  ImGui::PopFont();
  if (!hides) return;
  ImGui::SetCursorScreenPos({x, tile.rect.y + 2.0F * scale});
  ImGui::PushStyleColor(ImGuiCol_Button, ImVec4{0, 0, 0, 0});
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {0, 0});
  if (ImGui::Button(icons::kChevronDown, {more - 4.0F * scale, more - 4.0F * scale}))
    ImGui::OpenPopup("more tabs");
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("All %d panels of this tile", static_cast<int>(tile.tabs.size()));
  if (!ImGui::BeginPopup("more tabs")) return;
  for (const std::string& name : tile.tabs)
    if (ImGui::MenuItem(title_of(name).c_str(), nullptr, name == tile.panel))
      after_frame_ = [this, name] { bring_to_front(name); };
  ImGui::EndPopup();
}

}  // namespace stillpoint
