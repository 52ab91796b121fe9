#include <fmt/format.h>

#include <algorithm>

#include "core/check/check_sequence.hpp"
#include "core/evaluation/tables.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/panel.hpp"
#include "ui/panels/panel_command.hpp"
#include "ui/panels/panel_kit.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/plot/right_click.hpp"
#include "ui/session/debug_view.hpp"
#include "ui/session/session_view.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {
namespace {

/// A switch as a recent sequence keeps it: "depth_scale=1000".
std::string word_of(const Remedy& remedy) {
  std::string name = remedy.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return fmt::format("{}={}", name, remedy.value.empty() ? "true" : remedy.value);
}

/// What of the input cannot be right, and the switches that mend it.
class CheckPanel final : public NamedPanel {
 public:
  explicit CheckPanel(Shared shared) : NamedPanel("check", "Input check", std::move(shared)) {}

  [[nodiscard]] std::vector<PanelCommand> commands() override {
    return {{.name = "check_input",
             .title = "Question the input by all there is",
             .group = "Debug",
             .icon = icons::kSearch,
             .shows = true,
             .enabled = [](const SessionView& session) { return !session.debug.check.asking; },
             .run = [](const SessionView&,
                       PanelActions& actions) { actions.requests.emplace_back(request::CheckSequence{}); }}};
  }

  [[nodiscard]] PanelSize least() const override { return {340.0F, 180.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const CheckView& check = session.debug.check;
    Controls controls(frame);
    ImGui::BeginDisabled(check.asking);
    if (controls.button(check.whole ? "Question again" : "Question everything",
                        "Runs the odometry over the first frames: camera, depth scale, ground truth, times"))
      actions.perform.emplace_back("check_input");
    ImGui::EndDisabled();
    // Its bar is always there: one that came with the last line would wrap all others anew under the mouse.
    const ImVec2 low = ImGui::GetCursorScreenPos();
    ImGui::BeginChild("findings", {}, false, ImGuiWindowFlags_AlwaysVerticalScrollbar);
    ImGui::PushFont(frame.fonts.small);
    ImGui::PushStyleColor(ImGuiCol_Text, to_vec4(frame.theme.text_dim));
    text_in_lines(state_of(session));
    ImGui::PopStyleColor();
    ImGui::PopFont();
    if (!check.findings.empty() && ImGui::BeginTable("findings", 2, ImGuiTableFlags_BordersInnerH)) {
      ImGui::TableSetupColumn("about", ImGuiTableColumnFlags_WidthFixed, 76.0F * frame.scale);
      ImGui::TableSetupColumn("sentence", ImGuiTableColumnFlags_WidthStretch);
      for (std::size_t i = 0; i < check.findings.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        draw_finding(frame, check.findings[i], actions);
        ImGui::PopID();
      }
      ImGui::EndTable();
    }
    if (!check.times.empty()) {
      ImGui::Spacing();
      small_heading(frame, "When its rows were measured");
      for (const std::string& line : check.times) text_in_lines(line);
    }
    ImGui::EndChild();
    offer_table(frame, "findings", low, [&] {
      Table table{{"about", "finding"}, {}};
      for (const Finding& finding : check.findings) table.rows.push_back({finding.about, finding.sentence});
      return table;
    });
  }

 private:
  static std::string state_of(const SessionView& session) {
    const CheckView& check = session.debug.check;
    const std::string by = check.whole ? "by all there is" : "by its lists and a sample of its images";
    if (!check.looked && !check.whole && !check.asking) return "Not questioned yet.";
    if (check.asking) return "Being questioned: some seconds.";
    if (check.findings.empty()) return fmt::format("Questioned {}: nothing found.", by);
    return fmt::format("Questioned {}: {} finding{}.", by, check.findings.size(),
                       check.findings.size() == 1 ? "" : "s");
  }

  static void draw_finding(const UiFrame& frame, const Finding& finding, PanelActions& actions) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextColored(to_vec4(frame.theme.text_dim), "%s", finding.about.c_str());
    ImGui::TableNextColumn();
    text_in_lines(finding.sentence);
    if (const auto remedy = remedy_of(finding)) {
      const std::string label = fmt::format("Open again with {}", remedy->text());
      if (ImGui::Button(label.c_str())) actions.reopen_with = word_of(*remedy);
    }
  }
};

}  // namespace

std::unique_ptr<Panel> make_check_panel(Shared shared) {
  return std::make_unique<CheckPanel>(std::move(shared));
}

}  // namespace stillpoint
