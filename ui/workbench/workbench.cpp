#include "ui/workbench/workbench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "ui/panels/panel_kit.hpp"
#include "ui/panels/run_pictures.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"
#include "ui/theme/rounded.hpp"
#include "ui/theme/text.hpp"

namespace stillpoint {
namespace {

// Design px.
constexpr float kHeading = 27.0F, kLeastTile = 90.0F, kStatusHeight = 25.0F;
// In smaller tiles than these, controls are small too: the picture matters more.
constexpr float kCompactWidth = 380.0F, kCompactHeight = 330.0F;

constexpr ImGuiWindowFlags kRootFlags =
    ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
    ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoScrollWithMouse |
    ImGuiWindowFlags_NoBackground;  // the canvas is cleared in that colour

void begin_root(const UiFrame& frame, ImGuiWindowFlags flags) {
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize(frame.size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0F);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0.0F);
  ImGui::Begin("##workbench", nullptr, kRootFlags | flags);
  ImGui::PopStyleVar(3);
}

/// A rounded surface with a hairline and a heading strip.
void draw_card(const UiFrame& frame, const LayoutRect& rect, float heading, bool hovered) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float rounding = 6.0F * frame.scale;
  const ImVec2 low{rect.x, rect.y}, high{rect.x + rect.width, rect.y + rect.height};
  fill_rounded(list, low, high, to_u32(frame.theme.panel), rounding);
  list.AddRectFilled(low, {high.x, low.y + heading},
                     to_u32(mix(frame.theme.panel, frame.theme.raised, 0.55F)), rounding,
                     ImDrawFlags_RoundCornersTop);
  list.AddLine({low.x, low.y + heading}, {high.x, low.y + heading}, to_u32(frame.theme.border));
  list.AddRect(low, high,
               to_u32(hovered ? mix(frame.theme.border, frame.theme.accent, 0.45F) : frame.theme.border),
               rounding);
}

void draw_panel_body(UiFrame& frame, const SessionView& session, Panel& panel, const LayoutRect& rect,
                     PanelActions& wanted) {
  if (rect.width < 8.0F || rect.height < 8.0F) return;
  ImGui::SetCursorScreenPos({rect.x, rect.y});
  ImGui::PushStyleColor(ImGuiCol_ChildBg, ImVec4{0, 0, 0, 0});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {8.0F * frame.scale, 6.0F * frame.scale});
  const bool visible =
      ImGui::BeginChild(panel.name().c_str(), {rect.width, rect.height}, false,
                        ImGuiWindowFlags_AlwaysUseWindowPadding | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
  const bool compact = rect.width < kCompactWidth * frame.scale || rect.height < kCompactHeight * frame.scale;
  if (compact) {
    ImGui::PushFont(frame.fonts.small);
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {5.0F * frame.scale, 2.0F * frame.scale});
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {5.0F * frame.scale, 3.0F * frame.scale});
  }
  if (visible) draw_by_runs(frame, session, panel, wanted);
  if (compact) {
    ImGui::PopStyleVar(2);
    ImGui::PopFont();
  }
  ImGui::EndChild();
}

template <typename Visit>
void for_each_panel(LayoutNode& node, const Visit& visit) {
  if (node.is_panel()) visit(node);
  for (LayoutNode& child : node.children) for_each_panel(child, visit);
}

LayoutRect below_heading(const LayoutRect& rect, float heading) {
  return {rect.x + 1.0F, rect.y + heading + 1.0F, rect.width - 2.0F, rect.height - heading - 2.0F};
}

}  // namespace

Workbench::Workbench(std::vector<std::unique_ptr<Panel>> panels, WorkbenchHost host)
    : panels_(std::move(panels)), host_(std::move(host)), open_dialog_(host_.look) {
  set_layout(default_layout());
  add_actions();
}

std::vector<std::string> Workbench::panel_names() const {
  std::vector<std::string> names;
  for (const auto& panel : panels_) names.push_back(panel->name());
  return names;
}

Panel* Workbench::find_panel(const std::string& name) const {
  const auto it =
      std::find_if(panels_.begin(), panels_.end(), [&](const auto& panel) { return panel->name() == name; });
  return it == panels_.end() ? nullptr : it->get();
}

LayoutNode Workbench::layout() const {
  LayoutNode layout = layout_;
  for_each_panel(layout, [this](LayoutNode& tile) {
    const auto chosen = choices_.find(tile.panel);
    tile.choices = chosen == choices_.end() ? PanelChoices::Words() : chosen->second.changed();
    tile.front =
        std::find(fronts_.begin(), fronts_.end(), tile.panel) != fronts_.end() && !is_behind(tile.panel);
  });
  return layout;
}

void Workbench::set_layout(LayoutNode layout) {
  for_each_panel(layout, [this](const LayoutNode& tile) {
    if (!tile.choices.empty()) choices_[tile.panel].want(tile.choices);
    if (tile.front) bring_to_front(tile.panel);
  });
  for (const std::string& name : panels_of(layout))
    if (find_panel(name) == nullptr) remove_panel(layout, name);
  layout_ = std::move(layout);
  maximised_.clear();
}

void Workbench::say(std::string message, bool error) {
  message_ = std::move(message);
  message_is_error_ = error_open_ = error;
  said_s_ = time_s_;
  log_.add({time_s_, last_shown_, error, message_});
}

std::optional<LayoutRect> Workbench::tile_of(const std::string& panel) const {
  const auto found = tiles_.find(panel);
  if (found == tiles_.end()) return std::nullopt;
  return found->second;
}

void Workbench::draw(UiFrame& frame, const SessionView* session) {
  frame_ = &frame;
  session_ = session;
  time_s_ = frame.time_s;
  look_ = frame.wanted_look;
  follow_session();
  frame.log = &log_;
  frame.runs = &runs_;
  frame.busy = !opening_.empty() || (session != nullptr && session->busy);
  if (const auto before = std::exchange(before_frame_, {})) before();
  frame.offer = &offered_;
  const bool overlay = palette_.open || open_dialog_.is_open() || hand_on_dialog_.open || save_dialog_.open;
  const Action* refused = overlay ? nullptr : actions_.run_pressed_keys(ImGui::GetIO().WantTextInput);
  tell_refused(refused);

  tell_notice();
  begin_root(frame, ImGuiWindowFlags_MenuBar);
  draw_menu_bar();
  const float status = std::round(kStatusHeight * frame.scale), gap = std::round(kTileGap * frame.scale);
  if (session != nullptr) {
    draw_toolbar();
    draw_verdict();
  }
  const float top = ImGui::GetCursorScreenPos().y;
  tiles_area_ = {gap, top, frame.size.x - 2.0F * gap, frame.size.y - top - status - 1.0F};
  if (session != nullptr) {
    draw_tiles(tiles_area_);
  } else {
    tile_views_.clear();
    level_ = true;
    draw_start_page(tiles_area_);
  }
  draw_status_bar(status);
  ImGui::End();

  draw_opening();
  draw_error();
  draw_shortcuts();
  draw_palette();
  draw_open_dialog();
  draw_hand_on_dialog();
  draw_save_dialog();
  draw_exporting();
  look_ = frame.wanted_look;
  if (session != nullptr && host_.compare) host_.compare(compare_frames_);
  if (session != nullptr && host_.baseline) host_.baseline(runs_.wants_baseline(*session));
  compare_frames_ = false;
  previewed_.reset();
  visible_.clear();
  frame_ = nullptr;
  session_ = nullptr;
  if (const auto after = std::exchange(after_frame_, {})) after();
  remember_layout();
}

void Workbench::remember_layout() {
  constexpr std::size_t kKept = 50;  // layouts that can be gone back to
  // A divider that is being dragged has not come to rest.
  if (ImGui::IsMouseDown(ImGuiMouseButton_Left) || layout_seen_ == layout_) return;
  if (layout_seen_) layouts_before_.push_back(std::move(*layout_seen_));
  if (layouts_before_.size() > kKept) layouts_before_.erase(layouts_before_.begin());
  layout_seen_ = layout_;
}

void Workbench::draw_alone(UiFrame& frame, const SessionView& session, Panel& panel, PanelChoices& choices) {
  frame.choices = &choices;
  draw_alone(frame, session, panel);
  frame.choices = nullptr;
}

void Workbench::draw_alone(UiFrame& frame, const SessionView& session, Panel& panel) {
  begin_root(frame, 0);
  const float inset = std::round(4.0F * frame.scale), heading = std::round(kHeading * frame.scale);
  const LayoutRect rect{inset, inset, frame.size.x - 2.0F * inset, frame.size.y - 2.0F * inset};
  draw_card(frame, rect, heading, false);
  const float text_y = rect.y + 0.5F * (heading - ImGui::GetFontSize()), margin = 10.0F * frame.scale;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddText(frame.fonts.strong, frame.fonts.strong->FontSize, {rect.x + margin, text_y},
               to_u32(frame.theme.text), panel.title().c_str());
  const float title_width =
      frame.fonts.strong->CalcTextSizeA(frame.fonts.strong->FontSize, 1e6F, 0.0F, panel.title().c_str()).x;
  const double seconds = session.current->frame.timestamp - series_start(session);
  const float room = rect.width - title_width - 4.0F * margin;
  ImGui::PushFont(frame.fonts.small);
  const auto wide = [](const std::string& text) { return ImGui::CalcTextSize(text.c_str()).x; };
  const std::string frame_text = fmt::format("frame {} of {}", session.current->index, session.frame_count),
                    method = run_words(session);
  // Where there is no room for all of it, the time goes first.
  std::string where = fmt::format("{}   {}   {:.3f} s   {}", session.title, frame_text, seconds, method);
  if (wide(where) > room) where = fmt::format("{}   {}   {}", session.title, frame_text, method);
  const float width = std::min(wide(where), room);
  draw_clipped_text({rect.x + rect.width - margin - width, rect.y + 0.5F * (heading - ImGui::GetFontSize())},
                    where, width, to_u32(frame.theme.text_dim));
  ImGui::PopFont();
  PanelActions ignored;
  draw_panel_body(frame, session, panel, below_heading(rect, heading), ignored);
  ImGui::End();
}

void Workbench::draw_tiles(const LayoutRect& area) {
  tiles_.clear();
  if (!maximised_.empty()) {
    places_ = {{maximised_, area}};
    take_turns(places_);
    draw_tile(places_.front());
    return;
  }
  const PlacedLayout placed = placed_tiles(area);
  places_ = placed.panels;
  take_turns(placed.panels);
  hovered_panel_.clear();
  for (const PlacedPanel& panel : placed.panels) draw_tile(panel);
  draw_splitters(placed);
}

void Workbench::draw_splitters(const PlacedLayout& placed) {
  const float grip = 2.0F * frame_->scale;
  for (std::size_t i = 0; i < placed.splitters.size(); ++i) {
    const PlacedSplitter& splitter = placed.splitters[i];
    const LayoutRect& rect = splitter.rect;
    ImGui::SetCursorScreenPos(
        {rect.x - (splitter.upright ? grip : 0.0F), rect.y - (splitter.upright ? 0.0F : grip)});
    ImGui::PushID(static_cast<int>(i));
    const ImVec2 size{rect.width + (splitter.upright ? 2.0F * grip : 0.0F),
                      rect.height + (splitter.upright ? 0.0F : 2.0F * grip)};
    ImGui::InvisibleButton("splitter", {std::max(size.x, 1.0F), std::max(size.y, 1.0F)});
    const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
    ImGui::PopID();
    if (hovered || active) {
      ImGui::SetMouseCursor(splitter.upright ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
      ImGui::GetWindowDrawList()->AddRectFilled({rect.x, rect.y}, {rect.x + rect.width, rect.y + rect.height},
                                                to_u32(frame_->theme.accent, active ? 0.9F : 0.5F), grip);
    }
    const ImVec2 moved = ImGui::GetIO().MouseDelta;
    const float delta = splitter.upright ? moved.x : moved.y;
    if (active && delta != 0.0F)
      after_frame_ = [this, splitter, delta, least = kLeastTile * frame_->scale] {
        drag(layout_, splitter, delta, least);
      };
  }
}

void Workbench::draw_tile(const PlacedPanel& tile) {
  const std::string& name = tile.panel;
  const LayoutRect& rect = tile.rect;
  Panel* panel = find_panel(name);
  if (panel == nullptr) return;
  const float heading = std::round(kHeading * frame_->scale);
  const bool hovered =
      ImGui::IsMouseHoveringRect({rect.x, rect.y}, {rect.x + rect.width, rect.y + rect.height}, false) &&
      ImGui::IsWindowHovered(ImGuiHoveredFlags_ChildWindows);
  if (hovered) hovered_panel_ = name;
  tiles_[name] = rect;
  draw_card(*frame_, rect, heading, hovered && maximised_.empty());
  ImGui::PushID(name.c_str());
  draw_tile_heading(*panel, tile, heading);
  if (!has_view(name)) return ImGui::PopID();
  PanelActions wanted;
  frame_->choices = &choices_[name];
  const SessionView& session = visible(view_of(name), *panel);
  const bool preview = panel->previews() && shows_preview(session);
  draw_panel_body(*frame_, preview ? previewed(session) : session, *panel, below_heading(rect, heading),
                  wanted);
  frame_->choices = nullptr;
  ImGui::PopID();
  carry_out(wanted);
}

const SessionView& Workbench::visible(const SessionView& session, const Panel& panel) {
  // Pictures show the runs that are ticked for them, hidden elsewhere or not.
  if (runs_.hidden.empty() || panel.lists_runs() || panel.shows_a_run()) return session;
  std::unique_ptr<const SessionView>& kept = visible_[&session];
  if (!kept) kept = std::make_unique<const SessionView>(without_hidden(session, runs_));
  return *kept;
}

const SessionView& Workbench::previewed(const SessionView& session) {
  if (!previewed_ || previewed_->current != session.debug.preview)
    previewed_ = std::make_unique<const SessionView>(with_preview(session));
  return *previewed_;
}

void Workbench::carry_out(const PanelActions& wanted) {
  if (wanted.worst_by) worst_by_ = wanted.worst_by;
  if (wanted.go_to_frame) go_to(*wanted.go_to_frame);
  for (const std::string& action : wanted.perform) actions_.run(action);
  if (!wanted.reopen_with.empty() && host_.reopen)
    after_frame_ = [this, with = wanted.reopen_with] { host_.reopen(with); };
  compare_frames_ |= wanted.compare_frames;
  if (host_.request)
    for (const SessionRequest& wish : wanted.requests) host_.request(wish);
}

void draw_clipped_text(ImVec2 at, const std::string& text, float width, ImU32 colour) {
  const std::string shown = cut_to(*ImGui::GetFont(), text, width);
  if (!shown.empty()) ImGui::GetWindowDrawList()->AddText(at, colour, shown.c_str());
}

}  // namespace stillpoint
