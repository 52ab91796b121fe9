#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "ui/panels/all_panels.hpp"
#include "ui/theme/icons.hpp"

namespace stillpoint {
namespace {

std::string section_of(const Parameter& parameter) {
  return parameter.key.substr(0, parameter.key.find('.'));
}

/// "max_corners" as people read it: "Max corners".
std::string label_of(const Parameter& parameter) {
  std::string label = parameter.key.substr(parameter.key.find('.') + 1);
  std::replace(label.begin(), label.end(), '_', ' ');
  if (label.ends_with(" px")) label.resize(label.size() - 3);
  if (!label.empty()) label[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(label[0])));
  return label;
}

/// "depth_motion" as people read it.
std::string heading_of(const std::string& section) {
  std::string heading = section;
  std::replace(heading.begin(), heading.end(), '_', ' ');
  heading[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(heading[0])));
  return heading;
}

std::string value_text(const Parameter& parameter) {
  if (const auto* integer = std::get_if<int*>(&parameter.value)) return fmt::format("{}", **integer);
  if (const auto* text = std::get_if<std::string*>(&parameter.value)) return **text;
  return fmt::format("{}", *std::get<double*>(parameter.value));
}

bool contains(const std::string& text, const std::string& part) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return std::search(text.begin(), text.end(), part.begin(), part.end(), same) != text.end();
}

/// Every constant of the run, to read and to change.
class ParametersPanel final : public NamedPanel {
 public:
  explicit ParametersPanel(Shared shared) : NamedPanel("parameters", "Parameters", std::move(shared)) {}

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    // While a field is being edited its own value stands; everything else follows the session.
    if (!editing_) edited_ = session.config;
    editing_ = false;
    Config defaults, current = session.config;
    const std::vector<Parameter> shown = parameters(edited_), usual = parameters(defaults),
                                 now = parameters(current);
    draw_head(frame, now, usual);
    ImGui::BeginChild("list");
    std::string section;
    bool open = false;
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const bool changed = value_text(now[i]) != value_text(usual[i]);
      if (!matches(shown[i]) || (only_changed_ && !changed)) continue;
      if (section_of(shown[i]) != section) {
        if (open) ImGui::EndTable();
        section = section_of(shown[i]);
        open = begin_section(frame, section);
      }
      if (open) draw_row(frame, shown[i], usual[i], now[i], changed, actions);
    }
    if (open) ImGui::EndTable();
    ImGui::EndChild();
  }

 private:
  void draw_head(const UiFrame& frame, const std::vector<Parameter>& now,
                 const std::vector<Parameter>& usual) {
    ImGui::SetNextItemWidth(160.0F * frame.scale);
    ImGui::InputTextWithHint("##filter", "Filter", filter_.data(), filter_.size());
    ImGui::SameLine();
    ImGui::Checkbox("Changed only", &only_changed_);
    int changed = 0;
    for (std::size_t i = 0; i < now.size(); ++i)
      changed += value_text(now[i]) != value_text(usual[i]) ? 1 : 0;
    ImGui::SameLine();
    ImGui::TextDisabled("%d of %d differ from the defaults", changed, static_cast<int>(now.size()));
  }

  [[nodiscard]] bool matches(const Parameter& parameter) const {
    const std::string wanted = filter_.data();
    return wanted.empty() || contains(parameter.key, wanted) || contains(label_of(parameter), wanted) ||
           contains(parameter.help, wanted);
  }

  [[nodiscard]] static bool begin_section(const UiFrame& frame, const std::string& section) {
    ImGui::PushFont(frame.fonts.strong);
    ImGui::TextUnformatted(heading_of(section).c_str());
    ImGui::PopFont();
    const bool open = ImGui::BeginTable(section.c_str(), 4,
                                        ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingStretchProp);
    if (!open) return false;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, 1.25F);
    ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 0.95F);
    ImGui::TableSetupColumn("unit", ImGuiTableColumnFlags_WidthStretch, 1.2F);
    ImGui::TableSetupColumn("reset", ImGuiTableColumnFlags_WidthFixed, 26.0F * frame.scale);
    return true;
  }

  void draw_row(const UiFrame& frame, const Parameter& shown, const Parameter& usual, const Parameter& now,
                bool changed, PanelActions& actions) {
    ImGui::PushID(shown.key.c_str());
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    if (changed) {
      ImGui::TextColored(to_vec4(frame.theme.accent), "●");
      ImGui::SameLine();
      ImGui::PushFont(frame.fonts.strong);
    }
    ImGui::TextUnformatted(label_of(shown).c_str());
    if (changed) ImGui::PopFont();
    help(shown, usual);
    ImGui::TableNextColumn();
    ImGui::SetNextItemWidth(-1.0F);
    if (edit(shown) && value_text(shown) != value_text(now))
      actions.set_parameters.emplace_back(shown.key, value_text(shown));
    help(shown, usual);
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    ImGui::PushFont(frame.fonts.small);
    ImGui::TextDisabled("%s", range_text(shown).c_str());
    ImGui::PopFont();
    ImGui::TableNextColumn();
    if (changed) {
      if (ImGui::Button(icons::kUndo)) actions.set_parameters.emplace_back(shown.key, value_text(usual));
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("Back to %s", value_text(usual).c_str());
    }
    ImGui::PopID();
  }

  static void help(const Parameter& parameter, const Parameter& usual) {
    if (!ImGui::IsItemHovered()) return;
    ImGui::SetTooltip("%s\n%s\ndefault %s%s%s", parameter.key.c_str(), parameter.help.c_str(),
                      value_text(usual).c_str(), parameter.unit.empty() ? "" : " ", parameter.unit.c_str());
  }

  [[nodiscard]] static std::string range_text(const Parameter& parameter) {
    if (!parameter.choices.empty()) return fmt::format("one of {}", parameter.choices.size());
    return fmt::format("{}{}{:g} to {:g}", parameter.unit, parameter.unit.empty() ? "" : ", ", parameter.min,
                       parameter.max);
  }

  /// The field of a value. @returns whether a value was settled on.
  bool edit(const Parameter& parameter) {
    if (auto* text = std::get_if<std::string*>(&parameter.value)) {
      bool chosen = false;
      if (!ImGui::BeginCombo("##value", (*text)->c_str())) return false;
      for (const std::string& choice : parameter.choices) {
        if (ImGui::Selectable(choice.c_str(), choice == **text)) {
          **text = choice;
          chosen = true;
        }
      }
      ImGui::EndCombo();
      return chosen;
    }
    if (auto* integer = std::get_if<int*>(&parameter.value)) {
      const float speed =
          std::max(0.05F, 0.002F * static_cast<float>(std::min(parameter.max - parameter.min, 1000.0)));
      ImGui::DragInt("##value", *integer, speed, static_cast<int>(parameter.min),
                     static_cast<int>(parameter.max), "%d", ImGuiSliderFlags_AlwaysClamp);
    } else {
      double* real = std::get<double*>(parameter.value);
      const float speed =
          static_cast<float>(std::max(1e-5, std::min(0.005 * std::max(std::abs(*real), 0.1), 1.0)));
      ImGui::DragScalar("##value", ImGuiDataType_Double, real, speed, &parameter.min, &parameter.max, "%.6g",
                        ImGuiSliderFlags_AlwaysClamp);
    }
    if (ImGui::IsItemActive()) editing_ = true;
    return ImGui::IsItemDeactivatedAfterEdit();
  }

  Config edited_;
  bool editing_ = false, only_changed_ = false;
  std::array<char, 64> filter_{};
};

}  // namespace

std::unique_ptr<Panel> make_parameters_panel(Shared shared) {
  return std::make_unique<ParametersPanel>(std::move(shared));
}

}  // namespace stillpoint
