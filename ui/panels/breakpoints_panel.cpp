#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "core/evaluation/tables.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/run/condition.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/panel.hpp"
#include "ui/panels/panel_kit.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/plot/right_click.hpp"
#include "ui/session/data_sources.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {
namespace {

using Field = std::array<char, 256>;

struct Example {
  const char *expression, *meaning;
};

constexpr std::array<Example, 6> kExamples{
    {{"lost", "No pose could be estimated"},
     {"inliers < 30", "Few matches agree with the pose"},
     {"rpe > 2 cm", "The step from the frame before is off"},
     {"mask > 40%", "Much of the image is classified as dynamic"},
     {"keyframe && new_points < 20", "A keyframe that saw nothing new"},
     {"spike(residual, 4)", "The residual leaps above its usual"}}};

void fill(Field& field, const std::string& text) {
  std::strncpy(field.data(), text.c_str(), field.size() - 1);
  field.back() = '\0';
}

/// Conditions at which play stops: written here, counted, and gone to.
class BreakpointsPanel final : public NamedPanel {
 public:
  explicit BreakpointsPanel(Shared shared) : NamedPanel("breakpoints", "Breakpoints", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {340.0F, 180.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    draw_new(frame, session, actions);
    const ImVec2 low = ImGui::GetCursorScreenPos();
    ImGui::BeginChild("list");
    const auto& all = session.debug.breakpoints;
    fields_.resize(all.size());
    const int editing = editing_;
    editing_ = -1;
    for (std::size_t i = 0; i < all.size(); ++i) draw_row(frame, session, i, editing, actions);
    if (all.empty()) draw_examples(frame, session, actions);
    ImGui::EndChild();
    offer_table(frame, "breakpoints", low, [&] {
      Table table{{"condition", "on", "hits", "frames"}, {}};
      for (const BreakpointView& one : session.debug.breakpoints)
        table.rows.push_back({one.breakpoint.expression, one.breakpoint.enabled ? "yes" : "no",
                              fmt::format("{}", one.hits.size()),
                              fmt::format("{}", fmt::join(one.hits, " "))});
      return table;
    });
  }

 private:
  void draw_new(const UiFrame& frame, const SessionView& session, PanelActions& actions) {
    const ImGuiStyle& style = ImGui::GetStyle();
    const float left = ImGui::GetCursorScreenPos().x;
    const float add = ImGui::CalcTextSize("Add").x + 2.0F * style.FramePadding.x;
    const float more =
        ImGui::CalcTextSize("Examples").x + ImGui::CalcTextSize("Names").x + 5.0F * style.FramePadding.x;
    const float room = ImGui::GetContentRegionAvail().x;
    const bool beside = room > 340.0F * frame.scale;
    ImGui::PushFont(frame.fonts.mono);
    ImGui::SetNextItemWidth(beside ? room - add - more - 2.0F * style.ItemSpacing.x : room);
    check_new();
    if (focus_new_) ImGui::SetKeyboardFocusHere();
    focus_new_ = false;
    const bool entered = ImGui::InputTextWithHint("##new", "a condition: inliers < 30 || lost", new_.data(),
                                                  new_.size(), ImGuiInputTextFlags_EnterReturnsTrue);
    ImGui::PopFont();
    if (beside) ImGui::SameLine();
    const bool ready = new_[0] != '\0' && new_error_.empty();
    ImGui::BeginDisabled(!ready);
    if ((ImGui::Button("Add") || entered) && ready) {
      append(session, new_.data(), actions);
      new_ = {};
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (ImGui::Button("Examples")) ImGui::OpenPopup("examples");
    if (ImGui::BeginPopup("examples")) {
      draw_examples(frame, session, actions);
      ImGui::EndPopup();
    }
    ImGui::SameLine();
    if (ImGui::Button("Names")) ImGui::OpenPopup("names");
    draw_names(frame);
    if (!new_error_.empty()) draw_error(frame, checked_, new_error_, new_column_, left);
  }

  /// Reads what is being typed, so that what is wrong shows before it is added.
  void check_new() {
    if (checked_ == new_.data()) return;
    checked_ = new_.data();
    new_error_.clear();
    if (checked_.empty()) return;
    try {
      const Condition condition(checked_);
    } catch (const ConditionError& error) {
      new_error_ = error.what();
      new_column_ = error.column();
    }
  }

  /// All that a condition can ask for; a click puts the name into the new condition.
  void draw_names(const UiFrame& frame) {
    ImGui::SetNextWindowSize({0.0F, 24.0F * ImGui::GetTextLineHeightWithSpacing()});
    if (!ImGui::BeginPopup("names")) return;
    ImGui::TextDisabled("Click a name to use it. Units: m, cm, mm, deg, px, ms, s, %%. Also previous(x),");
    ImGui::TextDisabled("change(x), abs(x), spike(x, sigmas), &&, ||, ! and + - * /.");
    if (ImGui::BeginTable("names", 3, ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingFixedFit)) {
      for (const FigureInfo& info : frame_figure_infos()) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::PushFont(frame.fonts.mono);
        const bool wanted =
            ImGui::Selectable(std::string(info.name).c_str(), false, ImGuiSelectableFlags_SpanAllColumns);
        ImGui::PopFont();
        ImGui::TableNextColumn();
        ImGui::TextDisabled("%s", std::string(to_string(info.unit)).c_str());
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(std::string(info.help).c_str());
        if (!wanted) continue;
        const std::string typed = new_.data();
        fill(new_, typed + (typed.empty() || typed.ends_with(' ') ? "" : " ") + std::string(info.name) + " ");
        focus_new_ = true;
        ImGui::CloseCurrentPopup();
      }
      ImGui::EndTable();
    }
    ImGui::EndPopup();
  }

  static void append(const SessionView& session, const std::string& expression, PanelActions& actions) {
    std::vector<Breakpoint> all = breakpoints_of(session.debug);
    all.push_back({expression, true});
    actions.requests.push_back(request::Breakpoints{std::move(all)});
  }

  static void draw_examples(const UiFrame& frame, const SessionView& session, PanelActions& actions) {
    ImGui::PushStyleColor(ImGuiCol_Text, to_vec4(frame.theme.text_dim));
    text_in_lines("Play stops where a condition holds. Click one to add it:");
    ImGui::PopStyleColor();
    for (const Example& example : kExamples) {
      ImGui::PushID(example.expression);
      ImGui::PushFont(frame.fonts.mono);
      const bool wanted = ImGui::Button(example.expression);
      ImGui::PopFont();
      ImGui::SameLine();
      text_in_room(example.meaning, frame.theme.text_dim);
      ImGui::PopID();
      if (!wanted) continue;
      append(session, example.expression, actions);
      ImGui::CloseCurrentPopup();
    }
  }

  void draw_row(const UiFrame& frame, const SessionView& session, std::size_t index, int editing,
                PanelActions& actions) {
    const BreakpointView& view = session.debug.breakpoints[index];
    const auto replace = [&](const Breakpoint& wanted) {
      std::vector<Breakpoint> all = breakpoints_of(session.debug);
      all[index] = wanted;
      actions.requests.push_back(request::Breakpoints{std::move(all)});
    };
    ImGui::PushID(static_cast<int>(index));
    bool enabled = view.breakpoint.enabled;
    if (checkbox(frame, "##enabled", enabled)) replace({view.breakpoint.expression, enabled});
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip(enabled ? "Play stops here" : "Off: play does not stop here");
    ImGui::SameLine();
    const float side = ImGui::GetFrameHeight(), gap = ImGui::GetStyle().ItemSpacing.x;
    const std::string hits = view.error.empty()
                                 ? fmt::format("{} hit{}", view.hits.size(), view.hits.size() == 1 ? "" : "s")
                                 : "–";
    const float hits_width = ImGui::CalcTextSize("0000 hits").x;
    const float width = std::max(ImGui::GetContentRegionAvail().x - hits_width - 3.0F * side - 4.0F * gap,
                                 80.0F * frame.scale);
    Field& field = fields_[index];
    if (editing != static_cast<int>(index)) fill(field, view.breakpoint.expression);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::PushFont(frame.fonts.mono);
    ImGui::SetNextItemWidth(width);
    ImGui::InputText("##expression", field.data(), field.size());
    ImGui::PopFont();
    if (ImGui::IsItemActive()) editing_ = static_cast<int>(index);
    if (ImGui::IsItemDeactivatedAfterEdit() && view.breakpoint.expression != field.data())
      replace({field.data(), enabled});
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    const bool stopped = session.debug.stopped_by == static_cast<int>(index);
    const float left = ImGui::GetCursorPosX();
    if (stopped)
      ImGui::TextColored(to_vec4(frame.theme.accent), "%s", hits.c_str());
    else
      ImGui::TextUnformatted(hits.c_str());
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s%d frames of those processed so far", stopped ? "Play stopped here last. " : "",
                        static_cast<int>(view.hits.size()));
    ImGui::SameLine(left + hits_width + gap);
    draw_buttons(session, index, side, actions);
    if (!view.error.empty())
      draw_error(frame, view.breakpoint.expression, view.error, view.error_column, at.x);
    else if (!view.note.empty() && view.hits.empty())
      draw_note(frame, view.note, at.x);
    ImGui::PopID();
  }

  static void draw_buttons(const SessionView& session, std::size_t index, float side, PanelActions& actions) {
    const std::vector<int>& hits = session.debug.breakpoints[index].hits;
    const int here = session.current->index;
    const auto jump = [&](const char* icon, const char* tooltip, std::optional<int> to) {
      ImGui::BeginDisabled(!to);
      if (ImGui::Button(icon, {side, side}) && to) actions.go_to_frame = to;
      ImGui::EndDisabled();
      if (to && ImGui::IsItemHovered()) ImGui::SetTooltip("%s: frame %d", tooltip, *to);
      ImGui::SameLine();
    };
    jump(icons::kChevronLeft, "Hit before this frame", previous_in(hits, here));
    jump(icons::kChevronRight, "Hit after this frame", next_in(hits, here));
    if (ImGui::Button(icons::kClose, {side, side})) {
      std::vector<Breakpoint> all = breakpoints_of(session.debug);
      all.erase(all.begin() + static_cast<std::ptrdiff_t>(index));
      actions.requests.push_back(request::Breakpoints{std::move(all)});
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Delete");
  }

  /// The sentence below the place where the expression is wrong, which a sign points at.
  static void draw_error(const UiFrame& frame, const std::string& text, const std::string& error,
                         int at_column, float field_left) {
    const auto column = std::min(static_cast<std::size_t>(std::max(at_column, 0)), text.size());
    const ImFont* mono = frame.fonts.mono;
    const float x = field_left + ImGui::GetStyle().FramePadding.x +
                    mono->CalcTextSizeA(mono->FontSize, 1e6F, 0.0F, text.c_str(), text.c_str() + column).x;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float half = 0.25F * mono->FontSize, top = at.y - 0.5F * ImGui::GetStyle().ItemSpacing.y;
    const Rgb ink = role_colour(Role::kWarning, frame.theme.name);
    ImGui::GetWindowDrawList()->AddTriangleFilled(
        {x, top + 2.0F * half}, {x + 2.0F * half, top + 2.0F * half}, {x + half, top}, to_u32(ink));
    ImGui::SetCursorScreenPos({field_left, top + 2.2F * half});
    ImGui::PushFont(frame.fonts.small);
    ImGui::PushStyleColor(ImGuiCol_Text, to_vec4(ink));
    ImGui::TextWrapped("%s", error.c_str());
    ImGui::PopStyleColor();
    ImGui::PopFont();
  }

  /// Why a condition that can be read may never hold.
  static void draw_note(const UiFrame& frame, const std::string& note, float field_left) {
    ImGui::SetCursorScreenPos({field_left, ImGui::GetCursorScreenPos().y});
    ImGui::PushFont(frame.fonts.small);
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextWrapped("%s", note.c_str());
    ImGui::PopStyleColor();
    ImGui::PopFont();
  }

  Field new_{};
  std::string checked_, new_error_;  // what was typed when it was read last, and what is wrong with it
  int new_column_ = 0;
  bool focus_new_ = false;
  std::vector<Field> fields_;
  int editing_ = -1;  // index of the expression being typed
};

}  // namespace

std::unique_ptr<Panel> make_breakpoints_panel(Shared shared) {
  return std::make_unique<BreakpointsPanel>(std::move(shared));
}

}  // namespace stillpoint
