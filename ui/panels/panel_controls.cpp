// Rows of controls, whose values layouts keep.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "ui/panels/panel_choices.hpp"
#include "ui/panels/panel_kit.hpp"

namespace stillpoint {
namespace {

constexpr float kSliderWidth = 112.0F;  // design px
constexpr const char* kRoundId = "round";

void tooltip_of_last(const char* tooltip) {
  if (tooltip != nullptr && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tooltip);
}

}  // namespace

bool checkbox(const UiFrame& frame, const char* label, bool& on) {
  // Empty, it would hardly stand out from what it lies on.
  ImGui::PushStyleVar(ImGuiStyleVar_FrameBorderSize, std::max(1.0F, std::round(frame.scale)));
  ImGui::PushStyleColor(ImGuiCol_Border, to_vec4(mix(frame.theme.border, frame.theme.text_dim, 0.5F)));
  const bool changed = ImGui::Checkbox(label, &on);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar();
  return changed;
}

void Controls::place(float width) {
  const float edge = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  if (right_ > 0.0F && right_ + gap + width <= edge) ImGui::SameLine();
  right_ = ImGui::GetCursorScreenPos().x + width;
}

float Controls::text_width(const char* label) const { return ImGui::CalcTextSize(label, nullptr, true).x; }

bool Controls::choice(const char* id, const std::vector<std::string>& names, int& chosen,
                      const char* tooltip) {
  const auto shown = [&] {
    const bool any = chosen >= 0 && chosen < static_cast<int>(names.size());
    return any ? names[static_cast<std::size_t>(chosen)] : std::string();
  };
  bool changed = false;
  // Which round is shown is a matter of the frame, not of taste.
  const bool passing = std::string_view(id) == kRoundId;
  const bool kept = frame_.choices != nullptr && (!passing || frame_.choices->mirrors());
  if (kept) {
    const auto wanted = frame_.choices->take(id, shown());
    const auto found = wanted ? std::find(names.begin(), names.end(), *wanted) : names.end();
    if (found != names.end()) {
      chosen = static_cast<int>(found - names.begin());
      changed = true;
    } else if (wanted) {
      frame_.choices->refuse(id, *wanted);
    }
  }
  if (!frame_.controls) return changed;
  const float padding = ImGui::GetStyle().FramePadding.x, gap = frame_.scale;
  const auto width_of = [&](const std::string& name) { return text_width(name.c_str()) + 2.0F * padding; };
  float width = 0.0F;
  for (const std::string& name : names) width += width_of(name) + gap;
  place(width - gap);
  const float edge = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  float right = ImGui::GetCursorScreenPos().x;
  ImGui::PushID(id);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {gap, ImGui::GetStyle().ItemSpacing.y});
  for (int i = 0; i < static_cast<int>(names.size()); ++i) {
    // A choice wider than its panel goes on in the next line rather than out of sight.
    const float next = right + width_of(names[static_cast<std::size_t>(i)]);
    if (i > 0 && next <= edge) {
      ImGui::SameLine();
    } else if (i > 0) {
      right = ImGui::GetCursorScreenPos().x;
    }
    right += width_of(names[static_cast<std::size_t>(i)]) + gap;
    const bool on = i == chosen;
    if (on) {
      const Rgb ground = mix(frame_.theme.raised, frame_.theme.accent, 0.45F);
      ImGui::PushStyleColor(ImGuiCol_Button, to_vec4(ground));
      ImGui::PushStyleColor(ImGuiCol_ButtonHovered, to_vec4(ground));
    }
    if (ImGui::Button(names[static_cast<std::size_t>(i)].c_str()) && !on) {
      chosen = i;
      changed = true;
    }
    if (on) ImGui::PopStyleColor(2);
    tooltip_of_last(tooltip);
  }
  ImGui::PopStyleVar();
  ImGui::PopID();
  if (kept) frame_.choices->note(id, shown());
  if (passing && frame_.choices != nullptr) frame_.choices->note_passing(id, shown());
  right_ = right - gap;
  return changed;
}

bool Controls::toggle(const char* label, bool& on, const char* tooltip) {
  bool changed = false;
  if (frame_.choices != nullptr) {
    const auto wanted = frame_.choices->take(label, on ? "on" : "off");
    if (wanted && *wanted != "on" && *wanted != "off") {
      frame_.choices->refuse(label, *wanted);
    } else if (wanted) {
      on = *wanted == "on";
      changed = true;
    }
  }
  if (!frame_.controls) return changed;
  place(ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x + text_width(label));
  changed = checkbox(frame_, label, on) || changed;
  if (frame_.choices != nullptr) frame_.choices->note(label, on ? "on" : "off");
  tooltip_of_last(tooltip);
  return changed;
}

bool Controls::slider(const char* label, float& value, float low, float high, const char* format) {
  bool changed = false;
  const auto words = [&] { return fmt::format("{:.4g}", value); };
  if (frame_.choices != nullptr) {
    if (const auto wanted = frame_.choices->take(label, words())) {
      char* end = nullptr;
      const float number = std::strtof(wanted->c_str(), &end);
      changed = end != wanted->c_str() && *end == '\0' && std::isfinite(number);
      if (changed)
        value = std::clamp(number, low, high);
      else
        frame_.choices->refuse(label, *wanted);
    }
  }
  if (!frame_.controls) return changed;
  const float name = text_width(label);
  place(kSliderWidth * frame_.scale + (name > 0.0F ? ImGui::GetStyle().ItemInnerSpacing.x + name : 0.0F));
  ImGui::SetNextItemWidth(kSliderWidth * frame_.scale);
  changed = ImGui::SliderFloat(label, &value, low, high, format) || changed;
  if (frame_.choices != nullptr) frame_.choices->note(label, words());
  return changed;
}

void Controls::round(int rounds, int& chosen) {
  if (rounds < 2) return;
  std::vector<std::string> names{"Round 1"};
  for (int i = 2; i <= rounds; ++i) names.push_back(std::to_string(i));
  int shown = chosen < 0 ? rounds - 1 : std::min(chosen, rounds - 1);
  if (choice(kRoundId, names, shown, "Each round leaves out what the one before took for moving"))
    chosen = shown == rounds - 1 ? -1 : shown;
}

bool Controls::button(const char* label, const char* tooltip, bool* held) {
  if (!frame_.controls) return false;
  place(text_width(label) + 2.0F * ImGui::GetStyle().FramePadding.x);
  const bool pressed = ImGui::Button(label);
  if (held != nullptr) *held = ImGui::IsItemActive();
  tooltip_of_last(tooltip);
  return pressed;
}

}  // namespace stillpoint
