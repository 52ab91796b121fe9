#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"
#include "core/evaluation/tables.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/odometry/engines.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/panel.hpp"
#include "ui/panels/panel_kit.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/panels/parameter_rows.hpp"
#include "ui/plot/right_click.hpp"
#include "ui/session/debug_view.hpp"
#include "ui/session/session_view.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {
namespace {

constexpr float kFieldWidth = 22.0F;  // times the height of letters

/// Every constant of the run: to read, to try on the frame shown, and to run with.
class ParametersPanel final : public NamedPanel {
 public:
  explicit ParametersPanel(Shared shared) : NamedPanel("parameters", "Parameters", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {330.0F, 240.0F}; }

  void find(const std::string& words) override {
    filter_ = {};
    words.copy(filter_.data(), filter_.size() - 1);
    only_changed_ = false;
  }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    follow(session);
    Config defaults, run = session.config;
    const std::vector<Parameter> usual = parameters(defaults), now = parameters(run);
    draw_head(frame, session, actions);
    // The head's buttons may have discarded or reset what the sliders say, so it is read after them.
    Config wanted = wanted_;
    const ImVec2 low = ImGui::GetCursorScreenPos();
    ImGui::BeginChild("list");
    const std::vector<Parameter> shown = parameters(wanted);
    std::string section;
    bool open = false;
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const bool changed = value_text(shown[i]) != value_text(usual[i]);
      if (!matches(shown[i], filter_.data()) || (only_changed_ && !changed)) continue;
      if (section_of(shown[i]) != section) {
        if (open) ImGui::EndTable();
        section = section_of(shown[i]);
        open = begin_section(frame, section, is_live(shown[i]) && section != "run");
      }
      if (open) draw_row(frame, shown[i], usual[i], now[i]);
    }
    if (open) ImGui::EndTable();
    ImGui::EndChild();
    offer_table(frame, "parameters", low, [&] {
      Table table{{"parameter", "value", "this run's", "default", "unit"}, {}};
      for (std::size_t i = 0; i < shown.size(); ++i)
        table.rows.push_back(
            {shown[i].key, value_text(shown[i]), value_text(now[i]), value_text(usual[i]), shown[i].unit});
      return table;
    });
    // The rows have changed the copy: the frame shown is worked out anew with it.
    if (!changes(wanted, wanted_).empty()) want(wanted, session, actions);
  }

 private:
  /// What the sliders say stands until it is run with or discarded, whatever the session does meanwhile.
  void follow(const SessionView& session) {
    if (title_ != session.title) drafted_ = false;
    title_ = session.title;
    if (drafted_ && changes(wanted_, session.config).empty()) drafted_ = false;
    if (!drafted_) wanted_ = session.debug.preview_config.value_or(session.config);
  }

  void want(const Config& config, const SessionView& session, PanelActions& actions) {
    wanted_ = config;
    drafted_ = true;
    const bool differs = !changes(wanted_, session.config).empty();
    actions.requests.push_back(request::Preview{differs ? std::optional(wanted_) : std::nullopt});
  }

  void draw_head(const UiFrame& frame, const SessionView& session, PanelActions& actions) {
    ImGui::SetNextItemWidth(std::min(150.0F * frame.scale, 0.5F * ImGui::GetContentRegionAvail().x));
    ImGui::InputTextWithHint("##filter", "Search", filter_.data(), filter_.size());
    ImGui::SameLine();
    checkbox(frame, "Changed only", only_changed_);
    Controls controls(frame);
    if (controls.button("Compare with…", "Another method or preset, as a second run beside this one"))
      ImGui::OpenPopup("compare with");
    if (controls.button("Save as preset…", "These values as a TOML file for --config"))
      ImGui::OpenPopup("save");
    const std::vector<ParameterChange> from_usual = changes(wanted_, Config());
    ImGui::BeginDisabled(from_usual.empty());
    if (controls.button("Reset all", "Every value back to its default")) want(Config(), session, actions);
    ImGui::EndDisabled();
    draw_compare(session, actions);
    draw_save(actions);
    draw_run_bar(frame, session, actions);
    ImGui::PushFont(frame.fonts.small);
    ImGui::TextDisabled("%d differ%s from the default (●)", static_cast<int>(from_usual.size()),
                        from_usual.size() == 1 ? "s" : "");
    ImGui::PopFont();
  }

  /// What can be done with values that the run does not have.
  void draw_run_bar(const UiFrame& frame, const SessionView& session, PanelActions& actions) {
    const std::vector<ParameterChange> pending = changes(wanted_, session.config);
    if (pending.empty()) return;
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const float pad = 4.0F * frame.scale;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.ChannelsSplit(2);
    list.ChannelsSetCurrent(1);
    ImGui::SetCursorScreenPos({low.x + pad, low.y + pad});
    ImGui::BeginGroup();
    std::string working;
    if (shows_preview(session)) {
      working = session.debug.preview_ms > 0.0 ? fmt::format(", shown in {:.0f} ms", session.debug.preview_ms)
                                               : std::string(", shown");
      if (!session.debug.preview_whole) working += "; pose and matches follow";
    }
    ImGui::Text("%d change%s not run with%s", static_cast<int>(pending.size()),
                pending.size() == 1 ? "" : "s", working.c_str());
    if (ImGui::IsItemHovered()) describe_changes(pending);
    Controls controls(frame);
    const int here = session.current->index;
    const std::string name = change_name(wanted_, session.config);
    const bool processed = here < session.processed;
    ImGui::BeginDisabled(!processed);
    if (controls.button("Run from here", "As a second run beside this one, from the frame shown on"))
      add_ghost(wanted_, fmt::format("{}, from {}", name, here), here, actions);
    ImGui::EndDisabled();
    if (controls.button("Run beside", "As a second run beside this one, from the first frame on"))
      add_ghost(wanted_, name, 0, actions);
    if (controls.button("Run all", "This run begins anew with these values"))
      actions.requests.push_back(request::RunAll{wanted_});
    if (controls.button("Discard", "Back to what the run has")) {
      drafted_ = false;
      wanted_ = session.config;
      actions.requests.push_back(request::Preview{});
    }
    ImGui::EndGroup();
    const ImVec2 high{low.x + ImGui::GetContentRegionAvail().x, ImGui::GetItemRectMax().y + pad};
    list.ChannelsSetCurrent(0);
    list.AddRectFilled(low, high, to_u32(role_colour(Role::kWarning, frame.theme.name), 0.14F), pad);
    list.AddRectFilled(low, {low.x + 0.6F * pad, high.y},
                       to_u32(role_colour(Role::kWarning, frame.theme.name)), pad);
    list.ChannelsMerge();
    ImGui::SetCursorScreenPos({low.x, high.y + ImGui::GetStyle().ItemSpacing.y});
  }

  static void describe_changes(const std::vector<ParameterChange>& pending) {
    std::string text;
    for (const ParameterChange& one : pending)
      text += fmt::format("{}{}: {} → {}", text.empty() ? "" : "\n", one.key, one.before, one.value);
    ImGui::SetTooltip("%s", text.c_str());
  }

  static void add_ghost(const Config& config, const std::string& name, int from, PanelActions& actions) {
    actions.requests.push_back(request::AddGhost{config, name, from});
  }

  void draw_compare(const SessionView& session, PanelActions& actions) {
    if (!ImGui::BeginPopup("compare with")) return;
    Config config = session.config;
    ImGui::TextDisabled("Another method, all else alike");
    for (const Parameter& parameter : parameters(config)) {
      if (parameter.key != "run.method") continue;
      const std::string own = session.config.run.method;
      for (const std::string& method : parameter.choices) {
        if (method == own || !ImGui::Selectable(("Method " + method).c_str())) continue;
        config.run.method = method;
        add_ghost(config, "method " + method, 0, actions);
      }
    }
    ImGui::Separator();
    ImGui::TextDisabled("Another odometry, all else alike");
    for (const EngineInfo& engine : engines()) {
      config = session.config;
      if (engine.name == config.run.odometry) continue;
      config.run.odometry = engine.name;
      if (!why_no_pair(config).empty() || !ImGui::Selectable(("Odometry " + engine.name).c_str())) continue;
      add_ghost(config, "odometry " + engine.name, 0, actions);
    }
    ImGui::Separator();
    ImGui::TextDisabled("A preset, or a TOML file");
    for (const std::string& preset : preset_names())
      if (ImGui::Selectable(("Preset " + preset).c_str())) add_preset(preset, actions);
    ImGui::SetNextItemWidth(kFieldWidth * ImGui::GetFontSize());
    if (ImGui::InputTextWithHint("##file", "FILE.toml", file_.data(), file_.size(),
                                 ImGuiInputTextFlags_EnterReturnsTrue) &&
        add_preset(file_.data(), actions))
      ImGui::CloseCurrentPopup();
    if (!problem_.empty()) ImGui::TextWrapped("%s", problem_.c_str());
    ImGui::EndPopup();
  }

  bool add_preset(const std::string& name, PanelActions& actions) {
    try {
      add_ghost(load_config(name), "preset " + name, 0, actions);
      problem_.clear();
      return true;
    } catch (const InputError& error) {
      problem_ = error.what();
      return false;
    }
  }

  void draw_save(PanelActions& actions) {
    if (!ImGui::BeginPopup("save")) return;
    ImGui::TextUnformatted("Save these values as");
    ImGui::SetNextItemWidth(kFieldWidth * ImGui::GetFontSize());
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    const bool entered = ImGui::InputTextWithHint("##preset", "mine.toml", preset_.data(), preset_.size(),
                                                  ImGuiInputTextFlags_EnterReturnsTrue);
    ImGui::BeginDisabled(preset_[0] == '\0');
    if ((ImGui::Button("Save") || entered) && preset_[0] != '\0') {
      std::string file = preset_.data();
      if (!file.ends_with(".toml")) file += ".toml";
      actions.requests.push_back(request::SavePreset{wanted_, std::move(file)});
      ImGui::CloseCurrentPopup();
    }
    ImGui::EndDisabled();
    ImGui::EndPopup();
  }

  [[nodiscard]] static bool begin_section(const UiFrame& frame, const std::string& section, bool live) {
    ImGui::PushFont(frame.fonts.strong);
    ImGui::TextUnformatted(heading_of(section).c_str());
    ImGui::PopFont();
    if (live) {
      ImGui::SameLine();
      ImGui::TextColored(to_vec4(frame.theme.accent), "%s", icons::kBolt);
      if (ImGui::IsItemHovered())
        ImGui::SetTooltip("The frame shown follows while these are changed; the others act in a run");
    }
    const bool open = ImGui::BeginTable(section.c_str(), 4,
                                        ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingStretchProp);
    if (!open) return false;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, 1.2F);
    ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 1.15F);
    ImGui::TableSetupColumn("unit", ImGuiTableColumnFlags_WidthStretch, 1.05F);
    ImGui::TableSetupColumn("reset", ImGuiTableColumnFlags_WidthFixed, 26.0F * frame.scale);
    return true;
  }

  static void draw_row(const UiFrame& frame, const Parameter& shown, const Parameter& usual,
                       const Parameter& now) {
    const bool changed = value_text(shown) != value_text(usual);
    const bool pending = value_text(shown) != value_text(now);
    ImGui::PushID(shown.key.c_str());
    ImGui::TableNextRow();
    if (pending)
      ImGui::TableSetBgColor(ImGuiTableBgTarget_RowBg0,
                             to_u32(role_colour(Role::kWarning, frame.theme.name), 0.14F));
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    if (changed) {
      ImGui::TextColored(to_vec4(frame.theme.accent), "●");
      ImGui::SameLine();
      ImGui::PushFont(frame.fonts.strong);
    }
    text_in_room(label_of(shown), frame.theme.text);
    if (changed) ImGui::PopFont();
    help(shown, usual);
    ImGui::TableNextColumn();
    ImGui::SetNextItemWidth(-1.0F);
    edit(frame, shown);
    help(shown, usual);
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    ImGui::PushFont(frame.fonts.small);
    text_in_room(range_text(shown), frame.theme.text_dim);
    ImGui::PopFont();
    ImGui::TableNextColumn();
    if (changed) {
      if (ImGui::Button(icons::kUndo)) reset(shown, usual);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("Back to %s", value_text(usual).c_str());
    }
    ImGui::PopID();
  }

  static void reset(const Parameter& shown, const Parameter& usual) {
    if (auto* const* flag = std::get_if<bool*>(&shown.value)) **flag = *std::get<bool*>(usual.value);
    if (auto* const* integer = std::get_if<int*>(&shown.value)) **integer = *std::get<int*>(usual.value);
    if (auto* const* real = std::get_if<double*>(&shown.value)) **real = *std::get<double*>(usual.value);
    if (auto* const* text = std::get_if<std::string*>(&shown.value))
      **text = *std::get<std::string*>(usual.value);
  }

  static void help(const Parameter& parameter, const Parameter& usual) {
    if (!ImGui::IsItemHovered() || ImGui::IsItemActive()) return;
    ImGui::SetTooltip("%s\n%s\ndefault %s%s%s; %s\nCtrl and click to type a value", parameter.key.c_str(),
                      parameter.help.c_str(), value_text(usual).empty() ? "empty" : value_text(usual).c_str(),
                      parameter.unit.empty() ? "" : " ", parameter.unit.c_str(),
                      range_text(parameter).c_str());
  }

  static void edit(const UiFrame& frame, const Parameter& parameter) {
    if (auto* const* text = std::get_if<std::string*>(&parameter.value)) {
      if (parameter.choices.empty()) {
        std::array<char, 2048> field{};
        std::strncpy(field.data(), (*text)->c_str(), field.size() - 1);
        ImGui::InputText("##value", field.data(), field.size());
        if (ImGui::IsItemDeactivatedAfterEdit()) **text = field.data();
        return;
      }
      if (!ImGui::BeginCombo("##value", (*text)->c_str())) return;
      for (const std::string& choice : parameter.choices)
        if (ImGui::Selectable(choice.c_str(), choice == **text)) **text = choice;
      ImGui::EndCombo();
      return;
    }
    if (is_switch(parameter)) {
      checkbox(frame, "##value", *std::get<bool*>(parameter.value));
      return;
    }
    // A wide range is gone through by factors, so that small values can be hit too.
    const bool wide = parameter.max > 200.0 * std::max(parameter.min, 0.5);
    const ImGuiSliderFlags flags =
        ImGuiSliderFlags_AlwaysClamp | (wide ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None);
    if (auto* const* integer = std::get_if<int*>(&parameter.value))
      ImGui::SliderInt("##value", *integer, static_cast<int>(parameter.min), static_cast<int>(parameter.max),
                       "%d", flags);
    else
      ImGui::SliderScalar("##value", ImGuiDataType_Double, std::get<double*>(parameter.value), &parameter.min,
                          &parameter.max, "%.4g", flags);
  }

  Config wanted_;         // what the sliders say
  bool drafted_ = false;  // … which a person has changed
  std::string title_;     // of the sequence they were changed for
  bool only_changed_ = false;
  std::array<char, 64> filter_{};
  std::array<char, 512> file_{}, preset_{};
  std::string problem_;
};

}  // namespace

std::unique_ptr<Panel> make_parameters_panel(Shared shared) {
  return std::make_unique<ParametersPanel>(std::move(shared));
}

}  // namespace stillpoint
