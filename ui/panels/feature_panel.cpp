#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/evaluation/tables.hpp"
#include "core/geometry/pixel_conventions.hpp"
#include "core/inspect/feature_selection.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/feature_card.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/plot/right_click.hpp"
#include "ui/theme/fonts.hpp"

namespace stillpoint {
namespace {

constexpr double kShownPx = 110.0;  // of the frame, across the picture

using Facts = std::vector<std::pair<std::string, std::string>>;

std::string metres(const Eigen::Vector3d& p) {
  return fmt::format("{:.3f}, {:.3f}, {:.3f} m", p.x(), p.y(), p.z());
}

const char* link_text(TrailLink link) {
  switch (link) {
    case TrailLink::kItself:
      return "itself";
    case TrailLink::kMapPoint:
      return "same map point";
    case TrailLink::kFlow:
      return "where the flow leads";
    case TrailLink::kNearby:
      return "nearest of its kind";
  }
  return "";
}

Facts facts_of(const FeatureExplanation& explanation) {
  const FeatureRecord& f = explanation.feature;
  Facts facts{{"Pixel", fmt::format("{:.1f}, {:.1f}, octave {}", f.pixel.x, f.pixel.y, f.octave)},
              {"Depth", f.depth > 0.0F ? fmt::format("{:.3f} m", f.depth) : "not measured"}};
  if (f.map_point != kNone) {
    facts.emplace_back("Map point",
                       !explanation.measured.points ? fmt::format("{}", f.map_point)
                       : explanation.observations
                           ? fmt::format("{}, seen by {} keyframes", f.map_point, *explanation.observations)
                           : fmt::format("{}, since taken out of the map", f.map_point));
    if (!std::isnan(f.residual_px))
      facts.emplace_back("Reprojection residual", fmt::format("{:.2f} px", f.residual_px));
    if (explanation.measured.solving)
      facts.emplace_back("Weight in the pose", f.fate == FeatureFate::inlier
                                                   ? fmt::format("{:.0f} %", 100.0F * f.static_weight)
                                                   : std::string("none: an outlier"));
  } else {
    facts.emplace_back("Map point", f.fate == FeatureFate::removed ? "none looked for" : "none found");
  }
  const std::size_t back = explanation.trail.size() - 1;
  facts.emplace_back("Followed back", fmt::format("{} frame{}", back, back == 1 ? "" : "s"));
  if (explanation.mask_edge_px)
    facts.emplace_back("To the mask's edge",
                       fmt::format("{:.0f} px, {}", std::abs(*explanation.mask_edge_px),
                                   *explanation.mask_edge_px > 0.0 ? "inside" : "outside"));
  if (const auto motion = explanation.own_motion_px())
    facts.emplace_back("If static",
                       fmt::format("{:.1f}, {:.1f}: {:.1f} px away, by {}", explanation.if_static->x(),
                                   explanation.if_static->y(), *motion, explanation.static_by));
  if (explanation.in_camera) facts.emplace_back("In the camera", metres(*explanation.in_camera));
  if (explanation.in_world) facts.emplace_back("In the world", metres(*explanation.in_world));
  return facts;
}

/// One feature: what became of it, why, and where it came from.
class FeaturePanel final : public FramePanel {
 public:
  explicit FeaturePanel(Shared shared) : FramePanel("feature", "Feature", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {280.0F, 240.0F}; }
  [[nodiscard]] bool keeps_up() const override { return false; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const FrameView& view = *session.current;
    const std::string missing = missing_features(session);
    if (!missing.empty()) {
      draw_absent(frame, missing);
      return;
    }
    const std::optional<int> chosen = chosen_feature(session, *shared_);
    if (shared_->feature && !chosen) {
      draw_absent(frame,
                  fmt::format("The feature chosen in frame {} is not found in frame {}. Click another in a "
                              "features panel.",
                              shared_->feature->frame, view.index));
      return;
    }
    const std::optional<int> index = chosen ? chosen : telling_feature(*view.record, view.frame.gray.size());
    if (!index) {
      draw_absent(frame, fmt::format("Frame {} has no features.", view.index));
      return;
    }
    tell(session, *index);
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const bool wide = room.x > 1.25F * room.y;
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const ImVec2 size =
        wide ? ImVec2{std::floor(0.42F * room.x), room.y} : ImVec2{room.x, std::floor(0.42F * room.y)};
    draw_picture(frame, {session, actions}, size);
    if (wide) ImGui::SameLine(0.0F, gap);
    ImGui::BeginChild("explanation");
    draw_explanation(frame, chosen.has_value());
    ImGui::EndChild();
  }

 private:
  [[nodiscard]] static std::string missing_features(const SessionView& session) {
    const FrameView& view = *session.current;
    if (!view.frame.readable()) return missing_motion(session);
    if (view.record == nullptr) return fmt::format("Frame {} has not been processed yet.", view.index);
    if (!view.record->measured.features)
      return fmt::format("{} left no features of frame {}.", session.run->name, view.index);
    if (view.record->features.empty() && view.record->features_found > 0)
      return fmt::format("Frame {}'s {} features were not kept in its record.", view.index,
                         view.record->features_found);
    return {};
  }

  void tell(const SessionView& session, int index) {
    const bool same = !told_.owner_before(session.current) && !session.current.owner_before(told_);
    if (same && explanation_.index == index) return;
    const FrameView& view = *session.current;
    explanation_ = explain_feature(view, *session.run, session.camera, *session.map_points, index);
    told_ = session.current;
    const cv::Size size = view.frame.gray.size();
    view_.zoom = std::max(1.0, size.width / kShownPx);
    view_.centre =
        to_raster(explanation_.feature.pixel).px().cwiseQuotient(Eigen::Vector2d(size.width, size.height));
  }

  void draw_picture(const UiFrame& frame, const FramePlace& place, ImVec2 size) {
    const FrameView& view = *place.session.current;
    ImageContent content;
    content.texture = &ground_.get(frame, place.session.current, 0, [&] {
      outlines_ = outlines_of(view.mask);
      return view.frame.gray;
    });
    content.values = &view.frame.gray;
    const ImageResponse response = draw_image(frame, "picture", content, view_, size);
    take_mouse("picture", response, *shared_, place);
    push_clip(response);
    draw_outlines(frame, response, outlines_, role_colour(Role::kUnion, frame.theme.name));
    draw_explanation_marks(frame, response, explanation_);
    pop_clip();
    draw_marks(frame, response, *shared_, place);
  }

  void draw_explanation(const UiFrame& frame, bool chosen) const {
    const LegendEntry look = fate_look(explanation_.feature.fate, frame.theme.name);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float sign = 0.5F * ImGui::GetTextLineHeight();
    draw_sign(frame, *ImGui::GetWindowDrawList(), {at.x + sign, at.y + sign}, 4.5F * frame.scale, look.sign,
              to_u32(look.colour));
    ImGui::SetCursorScreenPos({at.x + 2.6F * sign, at.y});
    ImGui::PushFont(frame.fonts.strong);
    text_in_lines(explanation_.verdict);
    ImGui::PopFont();
    for (const std::string& sentence : explanation_.because) text_in_lines(sentence);
    for (const Margin& margin : explanation_.margins) draw_margin(frame, margin);
    ImGui::PushFont(frame.fonts.small);
    const ImVec2 low = ImGui::GetCursorScreenPos();
    if (ImGui::BeginTable("facts", 2, ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingStretchProp)) {
      ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed);
      ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch);
      for (const auto& [name, value] : facts_of(explanation_)) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextDisabled("%s", name.c_str());
        ImGui::TableNextColumn();
        text_in_lines(value);
      }
      ImGui::EndTable();
    }
    offer_table(frame, "feature", low, [&] {
      Table table{{"figure", "value"}, {}};
      for (const auto& [name, value] : facts_of(explanation_)) table.rows.push_back({name, value});
      return table;
    });
    draw_trail(frame);
    if (!chosen)
      ImGui::TextWrapped("No feature is chosen: this is the %s. Click another in a features panel.",
                         explanation_.feature.fate == FeatureFate::removed
                             ? "removed one nearest to the middle"
                             : "one with the largest residual");
    ImGui::PopFont();
  }

  /// The last frames, newest first.
  void draw_trail(const UiFrame& frame) const {
    if (explanation_.trail.size() < 2) return;
    const ImVec2 low = ImGui::GetCursorScreenPos();
    Table table{{"Frame", "Pixel", "Depth", "Then", "Found as"}, {}};
    if (!ImGui::BeginTable("trail", 5, ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingStretchProp))
      return;
    for (const std::string& name : table.header) ImGui::TableSetupColumn(name.c_str());
    ImGui::TableHeadersRow();
    for (const TrailPoint& point : explanation_.trail) {
      ImGui::TableNextRow();
      const FeatureRecord& f = point.feature;
      const LegendEntry look = fate_look(f.fate, frame.theme.name);
      const bool measured = f.fate == FeatureFate::inlier || f.fate == FeatureFate::outlier;
      const std::string fate = measured && !std::isnan(f.residual_px)
                                   ? fmt::format("{} {:.1f} px", look.name, f.residual_px)
                                   : look.name;
      const std::vector<std::string> cells = {
          fmt::format("{}", point.frame), fmt::format("{:.0f}, {:.0f}", f.pixel.x, f.pixel.y),
          f.depth > 0.0F ? fmt::format("{:.2f} m", f.depth) : "–", fate, link_text(point.link)};
      for (const std::string& cell : cells) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(cell.c_str());
      }
      table.rows.push_back(cells);
    }
    ImGui::EndTable();
    offer_table(frame, "feature_trail", low, [&] { return table; });
  }

  FeatureExplanation explanation_;
  std::weak_ptr<const FrameView> told_;
  ImageView view_;
  FrameTexture ground_;
  Outlines outlines_;
};

}  // namespace

std::unique_ptr<Panel> make_feature_panel(Shared shared) {
  return std::make_unique<FeaturePanel>(std::move(shared));
}

}  // namespace stillpoint
