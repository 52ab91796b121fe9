// What the workbench shows while no sequence is open.
#include <algorithm>

#include "ui/shell/event_log.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"
#include "ui/theme/theme.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {
namespace {

void paragraph(const UiFrame& frame, const char* icon, const char* head, const char* text) {
  ImGui::PushFont(frame.fonts.strong);
  ImGui::TextColored(to_vec4(frame.theme.accent), "%s", icon);
  ImGui::SameLine(30.0F * frame.scale);
  ImGui::TextUnformatted(head);
  ImGui::PopFont();
  ImGui::Indent(30.0F * frame.scale);
  ImGui::PushStyleColor(ImGuiCol_Text, to_vec4(frame.theme.text_dim));
  ImGui::TextWrapped("%s", text);
  ImGui::PopStyleColor();
  ImGui::Unindent(30.0F * frame.scale);
  ImGui::Spacing();
}

}  // namespace

void Workbench::draw_start_page(const LayoutRect& area) {
  const float scale = frame_->scale;
  const float width = std::min(620.0F * scale, area.width), left = area.x + 0.5F * (area.width - width);
  ImGui::SetCursorScreenPos({left, area.y + std::max(0.0F, 0.16F * area.height)});
  ImGui::PushStyleColor(ImGuiCol_ChildBg, ImVec4{0, 0, 0, 0});
  ImGui::BeginChild("start", {width, 0.82F * area.height});
  ImGui::PopStyleColor();
  ImGui::PushFont(frame_->fonts.heading);
  ImGui::TextColored(to_vec4(frame_->theme.accent), "%s", icons::kTarget);
  ImGui::SameLine();
  ImGui::TextUnformatted("Stillpoint");
  ImGui::PopFont();
  ImGui::TextWrapped(
      "See what a camera takes for moving, why, and what that does to the path it believes it took.");
  ImGui::Dummy({0, 12.0F * scale});

  paragraph(*frame_, icons::kFolderOpen, "Open a sequence",
            "Drop a folder on this window. A folder in the TUM RGB-D layout gives everything; a folder of "
            "colour frames "
            "shows motion alone.");
  paragraph(
      *frame_, icons::kPlay, "Press Space",
      "Frames are processed in the background: what is dynamic is masked, its features are removed, the "
      "pose is estimated "
      "from what is static.");
  paragraph(*frame_, icons::kSearch, "Look closer",
            "Step with the arrow keys, jump to lost frames with L, zoom into any picture with the wheel. "
            "Ctrl+Shift+P finds "
            "every action, ? lists the keys.");
  ImGui::Dummy({0, 8.0F * scale});
  ImGui::PushStyleColor(ImGuiCol_Button, to_vec4(mix(frame_->theme.raised, frame_->theme.accent, 0.45F)));
  if (ImGui::Button("Open the generated demo", {220.0F * scale, 34.0F * scale})) actions_.run("open_demo");
  ImGui::PopStyleColor();
  ImGui::SameLine();
  if (ImGui::Button("Open a folder…", {160.0F * scale, 34.0F * scale})) actions_.run("open");
  if (!recent_.empty()) {
    ImGui::Dummy({0, 12.0F * scale});
    ImGui::TextDisabled("Recent");
    for (const std::string& path : recent_)
      if (ImGui::Selectable(path.c_str()) && host_.open) after_frame_ = [this, path] { host_.open(path); };
  }
  ImGui::EndChild();
}

}  // namespace stillpoint
