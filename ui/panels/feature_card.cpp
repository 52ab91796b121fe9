#include "ui/panels/feature_card.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/pixel_conventions.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/view/image_widget.hpp"

namespace stillpoint {
namespace {

constexpr ImU32 kShade = IM_COL32(0, 0, 0, 170);

void draw_arrow(ImDrawList& list, ImVec2 from, ImVec2 to, ImU32 ink, float thick) {
  const float length = std::hypot(to.x - from.x, to.y - from.y);
  list.AddLine(from, to, ink, thick);
  if (length < 3.0F * thick) return;
  const ImVec2 along{(to.x - from.x) / length, (to.y - from.y) / length};
  const float head = std::min(5.0F * thick, 0.5F * length), wide = 0.55F * head;
  const ImVec2 neck{to.x - head * along.x, to.y - head * along.y};
  list.AddTriangleFilled(to, {neck.x - wide * along.y, neck.y + wide * along.x},
                         {neck.x + wide * along.y, neck.y - wide * along.x}, ink);
}

std::string margin_text(const Margin& margin) {
  return fmt::format("{}: {:.2f} {} {:.2f} {}", margin.name, margin.value,
                     margin.margin() > 0.0 ? "above" : "below", margin.limit, margin.unit);
}

}  // namespace

LegendEntry fate_look(FeatureFate fate, ThemeName theme) {
  switch (fate) {
    case FeatureFate::removed:
      return {"removed", role_colour(Role::kRemoved, theme), Sign::kCross};
    case FeatureFate::inlier:
      return {"inlier", role_colour(Role::kInlier, theme), Sign::kCircle};
    case FeatureFate::outlier:
      return {"outlier", role_colour(Role::kOutlier, theme), Sign::kTriangle};
    case FeatureFate::unmatched:
      break;
  }
  return {"unmatched", okabe_ito::kSkyBlue, Sign::kRing};
}

void draw_explanation_marks(const UiFrame& frame, const ImageResponse& response,
                            const FeatureExplanation& explanation) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 at = response.to_screen(to_raster(explanation.feature.pixel));
  const float thick = 1.8F * frame.scale;
  std::vector<ImVec2> trail;
  for (const TrailPoint& point : explanation.trail)
    trail.push_back(response.to_screen(to_raster(point.feature.pixel)));
  for (const auto& [ink, width] :
       {std::pair{kShade, thick + 2.0F * frame.scale}, std::pair{to_u32(okabe_ito::kYellow), thick}})
    list.AddPolyline(trail.data(), static_cast<int>(trail.size()), ink, ImDrawFlags_None, width);
  for (std::size_t i = 1; i < trail.size(); ++i)
    list.AddCircleFilled(trail[i], 1.8F * frame.scale, to_u32(okabe_ito::kYellow));
  if (explanation.if_static) {
    const ImVec2 still = response.to_screen(to_raster(*explanation.if_static));
    const Rgb colour = role_colour(Role::kBackward, ThemeName::kDark);
    draw_arrow(list, still, at, kShade, thick + 2.0F * frame.scale);
    draw_arrow(list, still, at, to_u32(colour), thick);
    draw_sign(frame, list, still, 3.5F * frame.scale, Sign::kHollowSquare, to_u32(colour));
  }
  list.AddCircle(at, 8.0F * frame.scale, kShade, 0, thick + 2.0F * frame.scale);
  list.AddCircle(at, 8.0F * frame.scale, IM_COL32(255, 255, 255, 255), 0, thick);
}

void draw_explanation_tooltip(const UiFrame& frame, const FeatureExplanation& explanation) {
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(330.0F * frame.scale);
  ImGui::TextUnformatted(explanation.verdict.c_str());
  ImGui::PushFont(frame.fonts.small);
  for (const std::string& sentence : explanation.because) ImGui::TextUnformatted(sentence.c_str());
  for (const Margin& margin : explanation.margins) ImGui::TextDisabled("%s", margin_text(margin).c_str());
  if (const auto motion = explanation.own_motion_px())
    ImGui::TextDisabled("%s", fmt::format("{:.1f} px from where it would be if static", *motion).c_str());
  ImGui::TextDisabled("Click to keep it chosen");
  ImGui::PopFont();
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void draw_margin(const UiFrame& frame, const Margin& margin) {
  const bool moving = margin.margin() > 0.0;
  const Rgb colour =
      moving ? role_colour(Role::kRemoved, frame.theme.name) : role_colour(Role::kKept, frame.theme.name);
  ImGui::PushFont(frame.fonts.small);
  ImGui::TextUnformatted(margin.name.c_str());
  const std::string figures =
      fmt::format("{:.2f} of {:.2f} {}  ({:+.2f})", margin.value, margin.limit, margin.unit, margin.margin());
  const float width = ImGui::GetContentRegionAvail().x;
  const float text = ImGui::CalcTextSize(figures.c_str()).x;
  if (ImGui::CalcTextSize(margin.name.c_str()).x + text + 12.0F * frame.scale < width) {
    ImGui::SameLine(0.0F, 0.0F);
    ImGui::SetCursorPosX(ImGui::GetWindowContentRegionMax().x - text);
  }
  ImGui::TextColored(to_vec4(frame.theme.text_dim), "%s", figures.c_str());
  ImGui::PopFont();
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const float height = 5.0F * frame.scale;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(low, {low.x + width, low.y + height}, to_u32(frame.theme.plot), 2.0F * frame.scale);
  const double share = margin.limit > 0.0 ? std::clamp(margin.value / (2.0 * margin.limit), 0.0, 1.0) : 0.0;
  list.AddRectFilled(low, {low.x + width * static_cast<float>(share), low.y + height}, to_u32(colour),
                     2.0F * frame.scale);
  list.AddLine({low.x + 0.5F * width, low.y - 2.0F * frame.scale},
               {low.x + 0.5F * width, low.y + height + 2.0F * frame.scale}, to_u32(frame.theme.text),
               1.5F * frame.scale);
  ImGui::Dummy({width, height + 3.0F * frame.scale});
}

}  // namespace stillpoint
